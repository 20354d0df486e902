#!/usr/bin/env bash
# check_two_computers.sh CARTVO: the odometry of one computer reaches another one, as docs/service.md says (Network of the
# messages), and with the default URL none leaves. Two network namespaces with a cable between them. Prints what the network
# carries. Exits with 77 (skipped) without root or namespaces.
set -euo pipefail
namespaces=(unshare --mount --net --pid --fork --mount-proc --kill-child)
if [ "${2-}" != inside ]; then
  if [ "$(id -u)" -ne 0 ] || ! "${namespaces[@]}" true; then
    echo "skipped: needs root and namespaces" && exit 77
  fi
  exec "${namespaces[@]}" "$(realpath "$0")" "$(realpath "$1")" inside
fi
cartvo=$1
make_sequence=$(dirname "$0")/../support/tools/make_still_sequence.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "check_two_computers: $*" >&2
  tail -n 20 "$folder"/*.log >&2
  exit 1
}

unshare --net sleep 1000 &
other=$!
on_other() { nsenter --net=/proc/$other/ns/net "$@"; }
while [ "$(readlink /proc/$other/ns/net)" = "$(readlink /proc/self/ns/net)" ]; do sleep 0.1; done
ip link set lo up
ip link add eth1 type veth peer name eth2 netns /proc/$other/ns/net
ip address add 192.0.2.1/24 dev eth1
ip link set eth1 up
ip route add 239.255.76.67/32 dev eth1 # what cartvo-multicast.service does with INTERFACE=eth1
on_other ip link set lo up
on_other ip address add 192.0.2.2/24 dev eth2
on_other ip link set eth2 up
on_other ip route add 239.255.76.67/32 dev eth2

"$make_sequence" "$folder/still"
run() { # URL: publishes, and watches for five seconds on the other computer; sets `bytes`, `seconds`, and writes watch.json
  "$cartvo" replay "$folder/still" --output-dir "$folder/out" --publish --loop --url "$1" >"$folder/publisher.log" 2>&1 &
  local publisher=$! before begin tries=0
  until grep -q 'publishing again' "$folder/publisher.log"; do
    [ $((tries += 1)) -lt 600 ] || fail "nothing is published"
    sleep 0.1
  done
  before=$(cat /sys/class/net/eth1/statistics/tx_bytes) begin=$(date +%s%N)
  code=0
  on_other "$cartvo" watch --url 'udpm://239.255.76.67:7667?ttl=1' --seconds 5 --wait 5 --json >"$folder/watch.json" 2>"$folder/watch.log" || code=$?
  bytes=$(($(cat /sys/class/net/eth1/statistics/tx_bytes) - before))
  seconds=$(($(date +%s%N) - begin))
  kill $publisher
  wait $publisher || true
}
mount -t sysfs sysfs /sys # of this namespace's interfaces

run 'udpm://239.255.76.67:7667?ttl=1'
[ $code -eq 0 ] || fail "the other computer received nothing: exit code $code"
awk -v bytes=$bytes -v ns=$seconds 'BEGIN { printf "check_two_computers: %.0f kbit/s on the cable\n", 8e6 * bytes / ns }'
if [ $bytes -lt 10000 ] || [ $bytes -gt 1000000 ]; then fail "$bytes bytes in five seconds"; fi
cat "$folder/watch.json"

run 'udpm://239.255.76.67:7667?ttl=0'
[ $code -ne 0 ] || fail "messages with ttl=0 have left the computer"
[ $bytes -lt 3000 ] || fail "$bytes bytes have left the computer with ttl=0"
