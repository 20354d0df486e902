#!/usr/bin/env bash
# tests/system/boot_vm.sh [WORK-FOLDER]: checks the installed package under a real systemd. Creates a Debian 12 disk image
# with the package of tools/package installed, boots it in QEMU (no KVM needed) and runs tests/system/in_vm.sh in it. Prints
# its PASS and FAIL lines, and exits with 0 only if all checks passed. CARTVO_VM_DEB=FILE installs a package that exists
# already. CARTVO_VM_CHECKS runs only some checks, such as "v4l2 netem" of: package service v4l2 netem. See
# tests/system/README.md.
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

build_programs() { # the package, and what the checks need beside it
  tools/setup
  cmake --preset release >"$work/build.log"
  cmake --build --preset release --target cartvo --target cartvo-render --target cartvo_capture_link_tests >>"$work/build.log"
  [ -n "${CARTVO_VM_DEB:-}" ] || tools/package "$work/package" >>"$work/build.log"
  package=${CARTVO_VM_DEB:-$(echo "$work"/package/cartvo_*.deb)}
}

make_debian() { # once: a small Debian, and the plugins of the simulated cameras
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" >"$work/debootstrap.log"
  [ ! -e "$root/made-for-cartvo" ] || return 0
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  chroot "$root" apt-get update -qq
  chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends systemd systemd-sysv \
    dbus udev kmod iproute2 initramfs-tools linux-image-amd64 v4l-utils gstreamer1.0-plugins-{base,good,bad} \
    >"$work/apt.log" 2>&1
  touch "$root/made-for-cartvo"
}

install_cartvo() { # as in the README; the previous installation is purged
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  rm -rf "$root/etc/cartvo" "$root/usr/bin/cartvo" "$root/usr/bin/cartvod"
  cp "$package" "$root/cartvo.deb"
  {
    chroot "$root" env CARTVO_PURGE_DATA=yes dpkg --purge cartvo
    chroot "$root" apt-get update -qq
    chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends --allow-downgrades /cartvo.deb
    chroot "$root" apt-get clean
  } >"$work/install.log" 2>&1
  rm "$root/cartvo.deb"
}

install_check() {
  install -m 755 tests/system/in_vm.sh tests/system/in_vm_package.sh "$root/usr/local/bin/"
  install -m 755 build/release/tests/capture/cartvo_capture_link_tests "$root/usr/local/bin/cartvo_capture_link_tests"
  install -m 644 tests/system/in-vm.service "$root/etc/systemd/system/in-vm.service"
  ln -sf ../in-vm.service "$root/etc/systemd/system/multi-user.target.wants/in-vm.service"
  # A getty would disconnect the serial line of the console.
  ln -sf /dev/null "$root/etc/systemd/system/serial-getty@ttyS0.service"
  # Rendering is slow under emulation: render the cameras' drive here.
  rm -rf "$root/var/lib/simulation"
  install -d "$root/var/lib/simulation"
  build/release/tools/cartvo/cartvo simulate "${content[@]}" --encode --output-dir "$root/var/lib/simulation/drive"
  rm -rf "$work/v4l2"
  build/release/tools/cartvo/cartvo simulate --world stop_and_go --seconds 1 --size 320x180 --frame-rate 2 --offset-ms 0 --readout-ms 0 \
    --render --output-dir "$work/v4l2"
  cp "$work/v4l2/rig.yaml" "$root/var/lib/simulation/v4l2-rig.yaml"
  echo "${CARTVO_VM_CHECKS:-all}" >"$root/var/lib/simulation/checks"
  cp "$package" "$root/var/lib/simulation/cartvo.deb" # for upgrades
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
