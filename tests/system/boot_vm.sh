#!/usr/bin/env bash
# tests/system/boot_vm.sh [WORK-FOLDER]: checks the installed service under a real systemd. Creates a Debian 12 disk image
# with the release build installed, boots it in QEMU (no KVM needed) and runs tests/system/in_vm.sh in it. Prints its PASS
# and FAIL lines, and exits with 0 only if all checks passed. CARTVO_VM_CHECKS=v4l2, netem or "v4l2 netem" runs only the
# checks of V4L2 cameras or of bad links, in a third of the time each. See tests/system/README.md.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=${1:-/var/tmp/cartvo-vm}
root=$work/root
max_seconds=3600 # for all checks; they take about twenty minutes
# Small pictures at a low rate, because the emulated processor is slow. Few packets per picture, so that some pictures
# arrive undamaged when one packet in twenty is lost.
content=(--world stop_and_go --seconds 12 --size 240x148 --frame-rate 3 --bitrate-kbps 200 --offset-ms 0 --readout-ms 0)
mkdir -p "$work"

for program in debootstrap qemu-system-x86_64 mke2fs; do
  command -v $program >/dev/null || {
    echo "boot_vm.sh: $program is missing: apt-get install debootstrap qemu-system-x86 e2fsprogs" >&2
    exit 2
  }
done
[ "$(id -u)" -eq 0 ] || { echo "boot_vm.sh: creating a disk image of Debian needs root" >&2; exit 2; }

build_programs() {
  tools/setup
  cmake --preset release >"$work/build.log"
  cmake --build --preset release --target cartvod --target cartvo --target cartvo_capture_link_tests >>"$work/build.log"
}

packages_of() { # the Debian packages that own the shared libraries of the programs
  ldd "$@" | awk '/=> \//{print $3}' | xargs -n1 realpath | sort -u | xargs dpkg-query -S 2>/dev/null | cut -d: -f1 | sort -u
}

make_debian() { # once: the packages of a cart, and those of the simulated cameras
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" >"$work/debootstrap.log"
  [ ! -e "$root/made-for-cartvo" ] || return 0
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  mapfile -t libraries < <(packages_of build/release/daemon/cartvod build/release/tools/cartvo/cartvo)
  chroot "$root" apt-get update -qq
  chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends systemd systemd-sysv \
    dbus udev kmod iproute2 initramfs-tools linux-image-amd64 v4l-utils gstreamer1.0-plugins-{base,good,bad} "${libraries[@]}" \
    >"$work/apt.log" 2>&1
  chroot "$root" apt-get clean
  touch "$root/made-for-cartvo"
}

install_cartvo() { # as in the README; removes the previous installation
  rm -rf "$root/etc/cartvo" "$root"/usr/lib/systemd/system/cartvo*
  DESTDIR=$root cmake --install build/release --prefix /usr >"$work/install.log"
}

install_check() {
  install -m 755 tests/system/in_vm.sh "$root/usr/local/bin/in_vm.sh"
  install -m 755 build/release/tests/capture/cartvo_capture_link_tests "$root/usr/local/bin/cartvo_capture_link_tests"
  install -m 644 tests/system/in-vm.service "$root/etc/systemd/system/in-vm.service"
  ln -sf ../in-vm.service "$root/etc/systemd/system/multi-user.target.wants/in-vm.service"
  # A getty would disconnect the serial line of the console.
  ln -sf /dev/null "$root/etc/systemd/system/serial-getty@ttyS0.service"
  # Rendering is slow under emulation: render the cameras' streams here, into the machine's cache.
  build/release/tools/cartvo/cartvo simulate "${content[@]}" --prepare-only --cache-dir "$work/streams"
  rm -rf "$root/var/lib/simulation"
  install -d "$root/var/lib/simulation"
  cp -r "$work/streams" "$root/var/lib/simulation/streams"
  printf '%s\n' "${content[@]}" >"$root/var/lib/simulation/content"
  rm -rf "$work/v4l2"
  build/release/tools/cartvo/cartvo simulate --world stop_and_go --seconds 1 --size 320x180 --frame-rate 2 --offset-ms 0 --readout-ms 0 \
    --render "$work/v4l2"
  cp "$work/v4l2/rig.yaml" "$root/var/lib/simulation/v4l2-rig.yaml"
  echo "${CARTVO_VM_CHECKS:-all}" >"$root/var/lib/simulation/checks"
}

boot() { # serial lines: console, output of the checks, the service's journal
  timeout --foreground "$max_seconds" qemu-system-x86_64 -accel tcg,thread=multi -cpu max -smp 2 -m 2048 -net none -display none \
    -monitor none -serial "file:$work/console.log" -serial stdio -serial "file:$work/journal.log" \
    -kernel "$(echo "$root"/boot/vmlinuz-*)" -initrd "$(echo "$root"/boot/initrd.img-*)" \
    -append "root=/dev/vda rw console=ttyS0 quiet" -drive "file=$work/disk.img,if=virtio,format=raw" </dev/null |
    sed -u 's/\r$//' | tee "$work/report.log" # serial lines end with \r\n
}

build_programs
make_debian
install_cartvo
install_check
rm -f "$work/disk.img"
mke2fs -q -t ext4 -d "$root" "$work/disk.img" 4G >/dev/null
echo "boot_vm.sh: Debian $(cat "$root/etc/debian_version") boots; console: $work/console.log, the service's journal: $work/journal.log"
boot || echo "boot_vm.sh: QEMU ended with $?" >&2

# Without the closing line the machine stalled, or did not reach the checks.
grep -q '^in_vm: [1-9][0-9]* passed, 0 failed$' "$work/report.log"
