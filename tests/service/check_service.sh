#!/bin/sh
# check_service.sh BUILD-FOLDER: installs into an empty root and holds the service to what systemd says of it: the units
# verify without a word, and the sandbox stays at or below exposure 2.0.
set -eu
build=$1
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
fail() { echo "check_service: $*" >&2; exit 1; }

# /usr as on a cart, whatever prefix this build was configured with.
DESTDIR=$root cmake --install "$build" --prefix /usr >"$root/install.log" 2>&1 || { cat "$root/install.log"; exit 1; }

units=$root/usr/lib/systemd/system
for file in usr/bin/cartvod usr/bin/cartvo etc/cartvo/cartvod.yaml usr/lib/sysusers.d/cartvo.conf \
  usr/share/man/man8/cartvod.8 usr/share/man/man5/cartvod.yaml.5 usr/share/man/man1/cartvo-watch.1; do
  [ -e "$root/$file" ] || fail "$file is not installed"
done

# An administrator's configuration survives the next installation.
echo '# mine' >>"$root/etc/cartvo/cartvod.yaml"
DESTDIR=$root cmake --install "$build" --prefix /usr >/dev/null
grep -q '^# mine' "$root/etc/cartvo/cartvod.yaml" || fail "cartvod.yaml was overwritten"

# The program must lie where the unit says; verify looks for it on this machine, so it is told this one's place.
grep -q '^ExecStart=/usr/bin/cartvod --config /etc/cartvo/cartvod.yaml$' "$units/cartvod.service" ||
  fail "cartvod.service does not start /usr/bin/cartvod: $(grep ^ExecStart "$units/cartvod.service")"
verify=$root/verify
mkdir "$verify"
sed "s|/usr/bin/cartvod|$root/usr/bin/cartvod|" "$units/cartvod.service" >"$verify/cartvod.service"
cp "$units/cartvo-multicast.service" "$verify"
said=$(SYSTEMD_UNIT_PATH=$verify: MANPATH=$root/usr/share/man systemd-analyze verify --man=no "$verify"/*.service 2>&1) ||
  fail "systemd-analyze verify: $said"
[ -z "$said" ] || fail "systemd-analyze verify: $said"

for unit in "$verify"/*.service; do
  systemd-analyze security --offline=yes --threshold=20 "$unit" >"$root/security.log" 2>&1 ||
    { cat "$root/security.log"; fail "$unit is too exposed"; }
  tail -1 "$root/security.log"
done

for page in "$root"/usr/share/man/man*/*; do
  warnings=$(LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=100 man --warnings -E UTF-8 -l -Tutf8 "$page" 2>&1 >/dev/null)
  [ -z "$warnings" ] || fail "$page: $warnings"
done
