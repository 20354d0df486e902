#!/bin/sh
# check_service.sh BUILD-FOLDER: installs into an empty root folder and checks the service: systemd-analyze verify accepts
# the units without a message, and the sandbox's exposure is at most 2.0.
set -eu
build=$1
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
fail() { echo "check_service: $*" >&2; exit 1; }

# Prefix /usr as on a cart, independent of the prefix of this build.
DESTDIR=$root cmake --install "$build" --prefix /usr >"$root/install.log" 2>&1 || { cat "$root/install.log"; exit 1; }

units=$root/usr/lib/systemd/system
for file in usr/bin/cartvod usr/bin/cartvo usr/libexec/cartvo/cartvo-watch etc/cartvo/cartvod.yaml usr/lib/sysusers.d/cartvo.conf \
  usr/share/man/man8/cartvod.8 usr/share/man/man5/cartvod.yaml.5 usr/share/man/man1/cartvo-watch.1 \
  usr/share/bash-completion/completions/cartvo usr/share/bash-completion/completions/cartvod; do
  [ -e "$root/$file" ] || fail "$file is not installed"
done

# A second installation must not overwrite the configuration.
echo '# mine' >>"$root/etc/cartvo/cartvod.yaml"
DESTDIR=$root cmake --install "$build" --prefix /usr >/dev/null
grep -q '^# mine' "$root/etc/cartvo/cartvod.yaml" || fail "cartvod.yaml was overwritten"

# The unit must name the installed program. verify looks for it on this machine, so the copy for verify names the
# temporary root.
grep -q '^ExecStart=/usr/bin/cartvod --config /etc/cartvo/cartvod.yaml$' "$units/cartvod.service" ||
  fail "cartvod.service does not start /usr/bin/cartvod: $(grep ^ExecStart "$units/cartvod.service")"
verify=$root/verify
mkdir "$verify"
sed "s|/usr/bin/cartvod|$root/usr/bin/cartvod|" "$units/cartvod.service" >"$verify/cartvod.service"
cp "$units/cartvo-multicast.service" "$verify"
messages=$(SYSTEMD_UNIT_PATH=$verify: MANPATH=$root/usr/share/man systemd-analyze verify --man=no "$verify"/*.service 2>&1) ||
  fail "systemd-analyze verify: $messages"
[ -z "$messages" ] || fail "systemd-analyze verify: $messages"

for unit in "$verify"/*.service; do
  systemd-analyze security --offline=yes --threshold=20 "$unit" >"$root/security.log" 2>&1 ||
    { cat "$root/security.log"; fail "$unit is too exposed"; }
  tail -1 "$root/security.log"
done

for page in "$root"/usr/share/man/man*/*; do
  warnings=$(LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=100 man --warnings -E UTF-8 -l -Tutf8 "$page" 2>&1 >/dev/null)
  [ -z "$warnings" ] || fail "$page: $warnings"
done
