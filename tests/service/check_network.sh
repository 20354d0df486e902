#!/usr/bin/env bash
# check_network.sh FOLDER: the example files of the cameras' network in FOLDER do what they say. In network namespaces
# systemd-networkd configures two ports with them: each has its address also without a camera, no default route appears, the
# computer counts as online, a camera that asks by DHCP gets the one address and no gateway. chronyd, if it is installed, serves the
# time to the camera and counts it as a client. sysctl accepts its file. Exits with 77 (skipped) without root, namespaces or systemd-networkd.
set -euo pipefail
files=$(realpath "$1")
networkd=/lib/systemd/systemd-networkd
namespaces=(unshare --mount --net --pid --fork --mount-proc --kill-child)
if [ "$(id -u)" -ne 0 ] || [ ! -x $networkd ] || ! "${namespaces[@]}" true; then
  echo "check_network: skipped: needs root, namespaces and systemd-networkd"
  exit 77
fi

if [ "${2-}" != inside ]; then
  # Not for real: the limit is one for the whole computer.
  [ "$(sysctl --dry-run -p "$files/60-cartvo-buffers.conf")" = 'net.core.rmem_max = 4194304' ] || {
    echo "check_network: sysctl does not accept 60-cartvo-buffers.conf" >&2
    exit 1
  }
  # A process number space of its own: when this script ends, so do all programs that it has started.
  exec "${namespaces[@]}" "$0" "$files" inside
fi
fail() {
  echo "check_network: $*" >&2
  cat /run/*.log >&2
  exit 1
}

run_networkd() { # LOG
  install -d -o systemd-network -g systemd-network /run/systemd/netif
  $networkd >"$1" 2>&1 &
}
own_folders() { # FOLDER-OF-NETWORK-FILES: nothing of this computer's configuration is used or changed
  mount --make-rprivate /
  mount -t tmpfs tmpfs /etc/systemd/network
  cp "$1"/*.network /etc/systemd/network
  # Read-only, as in a container: networkd then does not wait for udev.
  mount -t sysfs -o ro sysfs /sys
}
await() { # SECONDS COMMAND ...
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.1
  done
}
has_address() { ip -4 -o addr show dev "$1" | grep -q " $2 "; }
camera() { nsenter --net="/proc/$camera_pid/ns/net" --mount="/proc/$camera_pid/ns/mnt" "$@"; }
camera_has_address() { camera ip -4 -o addr show dev camera | grep -q " $1 "; }

mount -t tmpfs tmpfs /run
mkdir -p /run/camera-files
printf '[Match]\nName=camera\n[Network]\nDHCP=ipv4\nLinkLocalAddressing=no\nIPv6AcceptRA=no\n' >/run/camera-files/camera.network
own_folders "$files"
ip link set lo up
ip link add enp2s0 type veth peer name camera
ip link add enp3s0 type veth peer name other # stays down: a camera that is off

run_networkd /run/networkd.log
await 30 has_address enp2s0 192.168.101.1/24 || fail "the left port has no address"
await 30 has_address enp3s0 192.168.102.1/24 || fail "the right port has no address"
/lib/systemd/systemd-networkd-wait-online --timeout=30 || fail "starting the computer would wait for a camera"

# The camera, in namespaces of its own.
export -f run_networkd own_folders
export networkd
unshare --mount --net bash -c 'cp -r /run/camera-files /tmp/camera-files.$$; own_folders /tmp/camera-files.$$; rm -r /tmp/camera-files.$$
  mount -t tmpfs tmpfs /run; run_networkd /run/networkd.log; echo ready; wait' >/run/camera &
camera_pid=$!
await 30 grep -qs ready /run/camera || fail "the camera does not start"
ip link set camera netns $camera_pid
await 30 camera_has_address 192.168.101.64/24 || fail "the camera gets no address by DHCP"
camera grep -qr '^NTP=192.168.101.1$' /run/systemd/netif || fail "the camera is not told the time server"
[ -z "$(camera ip route show default)" ] || fail "the camera got a gateway"
[ -z "$(ip route show default)" ] || fail "a default route leads through a camera's port"
! grep -q '\.network:[0-9]' /run/networkd.log || fail "networkd does not understand a line"

if command -v chronyd >/dev/null; then
  chronyd -p -f "$files/cartvo-cameras.conf" >/run/chrony.log 2>&1 || fail "chronyd does not accept cartvo-cameras.conf"
  [ "$(grep -c '^allow ' /run/chrony.log)" -eq 2 ] || fail "chronyd does not serve two networks"
  install -d -o _chrony -g _chrony -m 750 /run/chrony
  chronyd -x -f "$files/cartvo-cameras.conf" >/run/chronyd.log 2>&1 || fail "chronyd does not start"
  camera chronyd -Q -t 20 -f /dev/null 'server 192.168.101.1 iburst' 'cmdport 0' 'bindcmdaddress /' 'pidfile /run/camera-chronyd.pid' \
    >/run/camera-chronyd.log 2>&1 || fail "the camera gets no time"
  # The columns that cartvo doctor reads: address, requests for the time.
  chronyc -n -c clients | grep -q '^192\.168\.101\.64,[1-9][0-9]*,' || fail "chronyd does not count the camera's requests"
else
  echo "check_network: chronyd is not installed: cartvo-cameras.conf is not checked"
fi
echo "check_network: in order"
