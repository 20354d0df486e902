#!/usr/bin/env bash
# tests/system/fresh_chroot.sh [FOLDER [SECONDS]]: checks that no installation step is missing. Installs a fresh Debian 12 in
# FOLDER (default: a temporary one), clones HEAD into it and runs the two commands of the README there, the demo with a drive
# of SECONDS (default: the demo's). Run by hand, as root.
# The real sequences are bind-mounted read-only if $CARTVO_DATA or ../shared/data exists.
set -euo pipefail
cd "$(dirname "$0")/../.."
repository=$PWD
data=$(realpath "${CARTVO_DATA:-$repository/../shared/data}" 2>/dev/null || true)
root=$(realpath "${1:-$(mktemp -d /var/tmp/cartvo-chroot.XXXXXX)}")

command -v debootstrap >/dev/null || { echo "fresh_chroot.sh: needs debootstrap (apt-get install debootstrap)" >&2; exit 1; }
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root"

trap 'umount -R "$root/proc" "$root/dev" "$root/sys" "$root/root/shared/data" 2>/dev/null || true' EXIT
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev" && mount --make-rslave "$root/dev"
mount --rbind /sys "$root/sys" && mount --make-rslave "$root/sys"
cp /etc/resolv.conf "$root/etc/resolv.conf"
rm -rf "$root/root/cartvo"
git clone -q "$repository" "$root/root/cartvo"
if [ -d "$data" ]; then
  mkdir -p "$root/root/shared/data"
  mount --bind -o ro "$data" "$root/root/shared/data"
fi

run() { echo "--- fresh Debian $(cat "$root/etc/debian_version"): $*"; chroot "$root" env -i HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
run /root/cartvo/tools/demo ${2:+--seconds "$2"}
run /root/cartvo/tools/test
echo "--- both commands pass on a fresh Debian $(cat "$root/etc/debian_version") ($root)"
