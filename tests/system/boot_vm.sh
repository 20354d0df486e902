#!/usr/bin/env bash
# tests/system/boot_vm.sh [WORK-FOLDER]: the installed service under a real systemd. Makes a Debian 12 disk image with the
# release build installed, boots it in QEMU (no KVM needed) and lets tests/system/in_vm.sh check there: waiting for
# absent cameras, readiness at the first valid odometry, restart after kill -9, a clean stop, the sandbox's exposure.
# Root; run by hand (some minutes; the image is kept in WORK-FOLDER, default /var/tmp/cartvo-vm).
set -euo pipefail
cd "$(dirname "$0")/../.."
work=${1:-/var/tmp/cartvo-vm}
root=$work/root
mkdir -p "$work"

for program in debootstrap qemu-system-x86_64 mke2fs; do
  command -v $program >/dev/null || {
    echo "boot_vm.sh: $program is missing: apt-get install debootstrap qemu-system-x86 e2fsprogs" >&2
    exit 1
  }
done
tools/build release

packages_of() { # the Debian packages that own the shared libraries of the programs
  ldd "$@" | awk '/=> \//{print $3}' | sort -u | xargs -n1 realpath | xargs dpkg-query -S 2>/dev/null | cut -d: -f1 | sort -u
}

if [ ! -e "$root/boot/made" ]; then
  echo "boot_vm.sh: making Debian in $root"
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  mapfile -t packages < <(packages_of build/release/daemon/cartvod build/release/tools/cartvo/cartvo)
  chroot "$root" apt-get update -qq
  chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends systemd systemd-sysv \
    dbus udev kmod iproute2 initramfs-tools linux-image-amd64 gstreamer1.0-plugins-base gstreamer1.0-plugins-good \
    "${packages[@]}" >"$work/apt.log" 2>&1
  touch "$root/boot/made"
fi

DESTDIR=$root cmake --install build/release >/dev/null
install -m 755 tests/system/in_vm.sh "$root/usr/local/bin/in_vm.sh"
install -D -m 600 /dev/null "$root/etc/cartvo/credentials/left-camera-password"
install -D -m 600 /dev/null "$root/etc/cartvo/credentials/right-camera-password"
cat >"$root/etc/systemd/system/in-vm.service" <<'END'
[Unit]
Description=checks of cartvo in this machine
After=network.target systemd-user-sessions.service
[Service]
Type=oneshot
ExecStart=/usr/local/bin/in_vm.sh
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
ExecStopPost=systemctl poweroff --no-block
END
ln -sf /etc/systemd/system/in-vm.service "$root/etc/systemd/system/multi-user.target.wants/in-vm.service"

# Rendering under emulation takes long: the stream is encoded here and put into the machine's cache.
rm -rf "$root/var/lib/simulation"
build/release/tools/cartvo/cartvo simulate --seconds 20 --size 340x210 --frame-rate 4 --prepare-only \
  --cache-dir "$root/var/lib/simulation/cache" --output-dir "$root/var/lib/simulation"

rm -f "$work/disk.img"
mke2fs -q -t ext4 -d "$root" "$work/disk.img" 3G
echo "boot_vm.sh: booting; the console is also in $work/console.log"
timeout 900 qemu-system-x86_64 -accel tcg,thread=multi -cpu max -smp 2 -m 2048 -nographic -no-reboot -net none \
  -kernel "$(ls "$root"/boot/vmlinuz-*)" -initrd "$(ls "$root"/boot/initrd.img-*)" \
  -append "root=/dev/vda rw console=ttyS0 quiet" -drive "file=$work/disk.img,if=virtio,format=raw" </dev/null | tee "$work/console.log"
grep -q '^in_vm: all passed' "$work/console.log"
