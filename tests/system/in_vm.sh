#!/usr/bin/env bash
# Runs inside the machine that tests/system/boot_vm.sh boots: checks the installed service as an administrator would see it.
set -uo pipefail

say() { echo "in_vm: $*"; }
fail() {
  say "FAILED: $*"
  journalctl -u cartvod -u cartvo-multicast --no-pager | tail -40
  exit 1
}
show() { systemctl show --value -p "$1" cartvod; }
await() { # await SECONDS DESCRIPTION COMMAND...
  local limit=$1 what=$2
  shift 2
  for _ in $(seq "$((limit * 2))"); do
    "$@" && { say "$what"; return; }
    sleep 0.5
  done
  fail "not within $limit s: $what"
}
is_active() { [ "$(show ActiveState)" = active ]; }
restarted() { [ "$(show NRestarts)" -ge 1 ] && is_active; }

systemd-sysusers
[ "$(id -un cartvo 2>/dev/null)" = cartvo ] || fail "no user cartvo"

simulate=(cartvo simulate --seconds 20 --size 340x210 --frame-rate 4 --loop --cache-dir /var/lib/simulation/cache
  --output-dir /var/lib/simulation --user admin)
cameras_on() {
  "${simulate[@]}" >/var/lib/simulation/log 2>&1 &
  cameras=$!
}
are_serving() { grep -q '^ready:' /var/lib/simulation/log; }

# The cameras' first start makes the rig file and the password that the administrator installs; then they are switched off.
cameras_on
await 120 "simulated cameras serve" are_serving
kill $cameras
wait $cameras
cp /var/lib/simulation/rig.yaml /etc/cartvo/rig.yaml
tr -d '\n' </var/lib/simulation/password >/etc/cartvo/credentials/left-camera-password
cp /etc/cartvo/credentials/left-camera-password /etc/cartvo/credentials/right-camera-password
sed -e 's|url: rtsp://192.168.1.64:554|url: rtsp://127.0.0.1:8554|' -e 's|url: rtsp://192.168.1.65:554|url: rtsp://127.0.0.1:8555|' \
  -e 's|^  frame_rate: 18|  frame_rate: 4|' -e 's|stall_timeout: 1$|stall_timeout: 10|' -e 's|features: 1000|features: 300|' \
  -i /etc/cartvo/cartvod.yaml

systemctl start --no-block cartvod
sleep 10
[ "$(show ActiveState)" = activating ] || fail "without cameras the service is $(show ActiveState), expected activating"
say "without cameras: waiting, not failed"

cameras_on
await 120 "ready at the first valid odometry" is_active
[ "$(ps -o user= -p "$(show MainPID)")" = cartvo ] || fail "the daemon does not run as its own user"
tr '\0' ' ' </proc/"$(show MainPID)"/cmdline | grep -q "$(cat /etc/cartvo/credentials/left-camera-password)" && fail "password in the process list"
journalctl -u cartvod --no-pager | grep -qF "$(cat /etc/cartvo/credentials/left-camera-password)" && fail "password in the journal"
say "own user; no password in process list or journal"

kill -9 "$(show MainPID)"
await 120 "restarted after kill -9, ready again" restarted

systemctl stop cartvod
[ "$(show Result) $(show ExecMainStatus)" = "success 0" ] || fail "stop: $(show Result), status $(show ExecMainStatus)"
say "stopped cleanly"

systemd-analyze security --no-pager cartvod | tail -1
systemd-analyze security --no-pager --threshold=20 cartvod >/dev/null || fail "the sandbox's exposure is above 2.0"
say "all passed"
