#!/usr/bin/env bash
# tests/system/package.sh [WORK-FOLDER]: checks the Debian packages of tools/package. Builds them twice, in folders and
# environments that differ, and compares the bytes; runs lintian; then installs, upgrades, removes and purges them in a bare
# Debian 12 in WORK-FOLDER (default: /var/tmp/cartvo-package). Exits with 0 only if all checks passed. Run by hand, as root.
# CARTVO_PACKAGES=FOLDER checks packages that exist already, without building. See tests/system/README.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(realpath -m "${1:-/var/tmp/cartvo-package}")
root=$work/root
failed=0

[ "$(id -u)" -eq 0 ] || { echo "package.sh: a chroot needs root" >&2; exit 2; }
for program in debootstrap lintian; do
  command -v $program >/dev/null || {
    echo "package.sh: $program is missing: apt-get install debootstrap lintian" >&2
    exit 2
  }
done
mkdir -p "$work"
unmount() { umount "$root/proc" "$root/var/cache/apt/archives" 2>/dev/null || true; }
trap unmount EXIT

check() { # DESCRIPTION COMMAND ...
  if "${@:2}" >"$work/check.log" 2>&1; then
    echo "PASS $1"
  else
    echo "FAIL $1"
    sed 's/^/     | /' "$work/check.log" | tail -20
    failed=$((failed + 1))
  fi
}
not() { ! "$@"; }
inside() { chroot "$root" env -i HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
install_packages() { inside apt-get install -y --no-install-recommends "$@" </dev/null; }
exists() { [ -e "$root/$1" ]; }
has_mode() { [ "$(stat -c '%a %u:%g' "$root/$1")" = "$2" ]; }

# --- building

build_twice() { # without the cache, and with what the cache has of other folders
  local cache=${CCACHE_DIR:-$HOME/.cache/ccache}
  tools/package "$work/one"
  (umask 077 && CARTVO_CCACHE=yes CCACHE_DIR=$cache TZ=Asia/Tokyo LC_ALL=C.UTF-8 HOME=/nonexistent tools/package "$work/the-other/folder")
}
are_the_same_bytes() {
  local package
  for package in "$work"/one/*.deb; do
    cmp "$package" "$work/the-other/folder/${package##*/}"
  done
}
names_no_folder() { ! grep -alF "$work" "$1"/usr/bin/*; }
controller_compiles() {
  rm -rf "$work/unpacked"
  dpkg-deb -x "$packages"/cartvo-dev_*.deb "$work/unpacked"
  echo '#include <cartvo/client.hpp>
#include <cartvo/health_t.hpp>
cartvo::health_t health;
int main() { return cartvo::client::ControllerOdometry().newest().kept() != 0; }' |
    g++ -x c++ -std=c++17 -I "$work/unpacked/usr/include" -o "$work/controller" - \
      -x none "$work"/unpacked/usr/lib/*/libcartvo_client.a -llcm && "$work/controller"
}
library_links() {
  rm -rf "$work/library" "$work/library-example"
  dpkg-deb -x "$packages"/libcartvo-dev_*.deb "$work/library"
  cmake -S "$work/library/usr/share/doc/libcartvo-dev/examples/01_odometry_on_images" -B "$work/library-example" \
    -DCMAKE_PREFIX_PATH="$work/library/usr"
  cmake --build "$work/library-example"
}
python_imports() {
  rm -rf "$work/python"
  dpkg-deb -x "$packages"/python3-cartvo_*.deb "$work/python"
  PYTHONPATH=$work/python/usr/lib/python3/dist-packages /usr/bin/python3 -B -c 'import cartvo.lcm
cartvo.Odometry(cartvo.StereoCamera(240.0, 170.0, 105.0, 0.1, 340, 210))'
}
has_java_types() { # made with the packages' own tools
  rm -rf "$work/java"
  dpkg-deb -x "$packages"/cartvo-java_*.deb "$work/java"
  local jars=/usr/share/java/lcm.jar:$work/java/usr/share/java/cartvo-types.jar
  echo 'class Decoding {
    public static void main(String[] arguments) throws Exception {
      cartvo.odometry_t sent = new cartvo.odometry_t();
      sent.utime = 42;
      lcm.lcm.LCMDataOutputStream out = new lcm.lcm.LCMDataOutputStream();
      sent.encode(out);
      System.out.println(new cartvo.odometry_t(new lcm.lcm.LCMDataInputStream(out.toByteArray())).utime);
    }
  }' >"$work/Decoding.java"
  [ "$(java -cp "$jars" "$work/Decoding.java")" = 42 ]
}

# --- a bare Debian

make_debian() {
  unmount
  rm -rf "$root"
  [ -e "$work/debian.tar" ] || {
    debootstrap --variant=minbase bookworm "$work/debian" >"$work/debootstrap.log"
    tar -C "$work/debian" -cf "$work/debian.tar" .
    rm -r "$work/debian"
  }
  mkdir -p "$root"
  tar -C "$root" -xf "$work/debian.tar"
  # Documentation and man pages are checked too.
  rm -f "$root"/etc/dpkg/dpkg.cfg.d/*
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  mount -t proc proc "$root/proc"
  mkdir -p "$work/archives/partial" # downloads, for the next run
  mount --bind "$work/archives" "$root/var/cache/apt/archives"
  mkdir "$root/packages"
  cp "$packages"/*.deb "$root/packages"
  inside apt-get update -qq
}

# --- installed

says_version() { [ "$(inside "$1" --version)" = "$1 $version" ]; }
is_not_enabled() { [ -z "$(find "$root/etc/systemd/system" -name 'cartvo*')" ]; }
has_user() { inside id cartvo && grep -q '^cartvo:.*:/usr/sbin/nologin$' "$root/etc/passwd"; }
has_no_user() { ! grep -q '^cartvo:' "$root/etc/passwd" "$root/etc/group"; }
has_only_the_two_programs() { [ "$(inside dpkg -L cartvo | grep bin/ | sort | xargs)" = "/usr/bin/cartvo /usr/bin/cartvod" ]; }
renders() { # beside cartvo, which finds it
  install_packages "/packages/cartvo-lab_${version}_$(dpkg --print-architecture).deb" &&
    inside cartvo simulate --render --seconds 0.1 --size 64x48 --output-dir /tmp/rendered && inside man -w cartvo-render &&
    inside apt-get remove -y cartvo-lab
}
has_man_pages() {
  local page
  for page in cartvo cartvod cartvod.yaml cartvo-watch cartvo-calibrate; do
    inside man -w "$page"
  done
}
completes() { # as bash-completion loads it
  # shellcheck disable=SC2016  # expanded by the inner shell
  inside bash -c 'source /usr/share/bash-completion/bash_completion; _completion_loader cartvo
    COMP_WORDS=(cartvo reco) COMP_CWORD=1; _cartvo; [ "${COMPREPLY[*]}" = recording ]'
}
is_conffile() { inside dpkg-query -W -f "\${Conffiles}" cartvo | grep -q '^ /etc/cartvo/cartvod.yaml '; }
is_checked() { # the configuration as delivered lacks only what is the user's: the rig and the passwords
  local code=0
  inside cartvod --config /etc/cartvo/cartvod.yaml --check-config || code=$?
  [ $code -eq 2 ]
}
accepts_a_rig() {
  cp "$root/usr/share/cartvo/rigs/roof-680x420.yaml" "$root/etc/cartvo/rig.yaml"
  for side in left right; do
    install -m 600 /dev/stdin "$root/etc/cartvo/credentials/$side-camera-password" <<<secret
  done
  inside cartvod --config /etc/cartvo/cartvod.yaml --check-config
}
is_verified() { [ -z "$(inside dpkg --verify cartvo)" ]; }
chrony_accepts_its_file() {
  install_packages chrony
  inside chronyd -p -f /usr/share/cartvo/network/cartvo-cameras.conf | grep -qx 'allow 192.168.101.0/24'
}

# --- upgraded, removed

upgrade() { # to the same package with a newer version and another configuration as delivered
  rm -rf "$work/newer"
  dpkg-deb -R "$root"/packages/cartvo_*.deb "$work/newer"
  sed -i "s/^Version: .*/Version: $version+newer/" "$work/newer/DEBIAN/control"
  echo '# newer' >>"$work/newer/etc/cartvo/cartvod.yaml"
  (cd "$work/newer" && find . -type f ! -path './DEBIAN/*' -printf '%P\0' | xargs -0 md5sum >DEBIAN/md5sums)
  dpkg-deb --root-owner-group -b "$work/newer" "$root/packages/newer.deb"
  install_packages -o Dpkg::Options::=--force-confdef -o Dpkg::Options::=--force-confold /packages/newer.deb
  [ "$(inside dpkg-query -W -f "\${Version}" cartvo)" = "$version+newer" ]
}
configuration_is_mine() { [ "$(tail -n 1 "$root/etc/cartvo/cartvod.yaml")" = '# mine' ]; }
rig_is_mine() { [ -s "$root/etc/cartvo/rig.yaml" ]; }
record() { # as the service would have
  install -d -m 700 "$root/var/lib/cartvo/recordings/2026-11-26T12-00-00Z" "$root/var/cache/cartvo"
  echo '{}' >"$root/var/lib/cartvo/recordings/2026-11-26T12-00-00Z/recording.json"
  inside chown -R cartvo:cartvo /var/lib/cartvo /var/cache/cartvo
}
keeps_the_recording_for_root() {
  has_mode var/lib/cartvo/recordings/2026-11-26T12-00-00Z '700 0:0' && exists var/lib/cartvo/recordings/2026-11-26T12-00-00Z/recording.json
}
leaves_nothing() { [ -z "$(find "$root"/etc "$root"/var/lib "$root"/var/cache "$root"/usr "$root"/lib/systemd -iname '*cartvo*' \
  -not -path '*/apt/*' -print | tee /dev/stderr)" ]; }

packages=${CARTVO_PACKAGES:-$work/one}
if [ -z "${CARTVO_PACKAGES:-}" ]; then
  check "tools/package builds, twice" build_twice
  check "both builds are the same bytes" are_the_same_bytes
fi
packages=$(realpath "$packages")
version=$(dpkg-parsechangelog -S Version)
check "lintian has no errors and no warnings" lintian --allow-root --fail-on error,warning "$packages"/*.changes
check "a controller compiles with cartvo-dev" controller_compiles
check "an example links libcartvo-dev" library_links
check "a program in Python imports python3-cartvo" python_imports
check "a program in Java decodes odometry with cartvo-java" has_java_types

check "a bare Debian 12" make_debian
check "apt install ./cartvo.deb" install_packages "/packages/cartvo_${version}_$(dpkg --print-architecture).deb"
check "the installed files are whole" is_verified
check "cartvo --version is $version" says_version cartvo
check "cartvod --version is $version" says_version cartvod
check "the programs name no folder of their build" names_no_folder "$root"
check "no other program is installed" has_only_the_two_programs
check "the user cartvo exists" has_user
check "the service is not enabled" is_not_enabled
check "the folder of the passwords is root's alone" has_mode etc/cartvo/credentials '700 0:0'
check "the configuration is a conffile" is_conffile
check "the configuration as delivered misses a rig: exit 2" is_checked
check "with the example rig and passwords it is in order" accepts_a_rig
check "man and bash-completion install beside it" install_packages man-db bash-completion
check "the man pages are found" has_man_pages
check "with cartvo-lab beside it, it renders a drive" renders
check "bash completes" completes
check "chronyd accepts the example file" chrony_accepts_its_file

echo '# mine' >>"$root/etc/cartvo/cartvod.yaml"
record
check "an upgrade with another configuration as delivered" upgrade
check "the upgrade kept the configuration" configuration_is_mine
check "the upgrade kept the rig" rig_is_mine
check "apt remove" inside apt-get remove -y cartvo
check "removing removed the programs" not exists usr/bin/cartvod
check "removing kept the configuration" configuration_is_mine
inside touch /etc/cartvo/known-cameras
check "apt purge" inside apt-get purge -y cartvo
check "purging kept the recording, for root" keeps_the_recording_for_root
check "purging kept the rig" rig_is_mine
check "purging removed the configuration" not exists etc/cartvo/cartvod.yaml
check "purging removed the passwords" not exists etc/cartvo/credentials
check "purging removed the keys of cameras" not exists etc/cartvo/known-cameras
check "purging removed the cache" not exists var/cache/cartvo
check "purging removed the user" has_no_user
check "installing again" install_packages "/packages/cartvo_${version}_$(dpkg --print-architecture).deb"
inside cp /usr/share/cartvo/rigs/roof-680x420.yaml /etc/cartvo/rig.yaml
check "apt purge with CARTVO_PURGE_DATA=yes" inside CARTVO_PURGE_DATA=yes apt-get purge -y cartvo
check "that leaves nothing" leaves_nothing

echo "package.sh: $failed failed; packages in $packages"
[ "$failed" -eq 0 ]
