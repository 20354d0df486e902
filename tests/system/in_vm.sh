#!/usr/bin/env bash
# Runs inside the machine that tests/system/boot_vm.sh boots, and checks the installed package as an administrator sees it:
# sets the service up by the steps of cartvod(8), causes the faults that occur on a cart, and checks systemd, the journal and LCM.
# Prints a PASS or FAIL line for each check, and a closing line with their numbers. After the first half the machine reboots,
# because a cart is switched on without an operator.
set -uo pipefail

readonly state=/var/lib/in_vm           # survives the second boot
readonly credentials=/etc/cartvo/credentials
readonly configuration=/etc/cartvo/cartvod.yaml
readonly simulation=/var/lib/simulation
mkdir -p "$state"

# shellcheck source=/dev/null
source "$(dirname "$0")/in_vm_package.sh"

# --- the report

say() { echo "in_vm: $*"; }
check() { # check DESCRIPTION COMMAND...
  local what=$1 started=$SECONDS
  shift
  if "$@"; then
    echo "PASS $what ($((SECONDS - started)) s)"
    echo . >>"$state/passed"
  else
    echo "FAIL $what ($((SECONDS - started)) s)"
    echo . >>"$state/failed"
    systemctl status --no-pager --lines=15 cartvod 2>&1 | sed 's/^/     | /'
  fi
}
lines() { if [ -e "$1" ]; then wc -l <"$1"; else echo 0; fi; }
await() { # await SECONDS COMMAND...
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.5
  done
}
holds_for() { # holds_for SECONDS COMMAND...: COMMAND succeeds all the time
  local end=$((SECONDS + $1))
  shift
  while [ $SECONDS -lt $end ]; do
    "$@" || return 1
    sleep 1
  done
}

# --- state of systemd and the journal

show() { systemctl show --value -p "$1" cartvod; }
is() { [ "$(show "$1")" = "$2" ]; }
pid() { show MainPID; }
is_active() { is ActiveState active; }
mark() { # with -n 0 there is sometimes no cursor
  until journal_mark=$(journalctl -n 1 -o cat --show-cursor | sed -n 's/^-- cursor: //p') && [ -n "$journal_mark" ]; do sleep 1; done
}
journal() { journalctl -u cartvod --after-cursor="$journal_mark" --no-pager "$@"; }
logged() { journal -o cat | grep -E "$1" >/dev/null; } # since the mark; not grep -q, which would break journalctl's pipe
is_ready_again() { [ "$(pid)" != "$1" ] && [ "$(show NRestarts)" -gt "$2" ] && is_active; } # PID NRESTARTS: before
is_same_process() { is MainPID "$1" && is NRestarts "$2" && is_active; }

# --- what a controller receives over LCM, as the unprivileged user nobody

received() { # received SECONDS COMPARISON...: such as 'valid -gt 10', on the summary of `cartvo watch`
  local file value
  file=$(mktemp)
  setpriv --reuid=nobody --regid=nogroup --clear-groups cartvo watch --plain --wait 30 --seconds "$1" --json >"$file" 2>/dev/null
  shift
  while [ $# -gt 0 ]; do
    value=$(sed -n 's/^ *"'"$1"'": \([0-9]*\).*/\1/p' "$file")
    if [ -z "$value" ] || ! test "$value" "$2" "$3"; then
      echo "     | $1 is '$value', expected $2 $3"
      return 1
    fi
    shift 3
  done
}

# --- the two simulated cameras, each at its own address

readonly left_address=127.0.0.1 right_address=127.0.0.2
cameras_on() {
  local before
  before=$(journalctl -n 0 --show-cursor | sed -n 's/^-- cursor: //p')
  systemd-run --quiet --collect --unit=cameras -E HOME=/root cartvo simulate --recording $simulation/drive --loop \
    --output-dir "$simulation" \
    --left-address $left_address:8554 --right-address $right_address:8554
  await 120 are_serving "$before"
}
are_serving() { journalctl -u cameras --after-cursor="$1" --no-pager -o cat | grep '^ready: ' >/dev/null; }
cameras_off() { systemctl stop cameras; }
pull_cable() { ip route add blackhole "$1/32" table local; } # packets are dropped, connections stay open
plug_cable() { ip route delete blackhole "$1/32" table local; }

# --- V4L2: the kernel's two simulated cameras

plug_v4l2() { modprobe vivid n_devs=2 node_types=0x1,0x1 multiplanar=1,1 && udevadm settle; }
readonly vivid=/sys/bus/platform/drivers/vivid
unplug_v4l2() { echo vivid.0 >$vivid/unbind; } # removes the devices while they are in use
replug_v4l2() { echo vivid.0 >$vivid/bind && udevadm settle; }
use_v4l2() {
  mkdir -p /etc/systemd/system/cartvod.service.d
  printf '[Service]\nPrivateDevices=no\nDeviceAllow=char-81 rw\nSupplementaryGroups=video\nLoadCredential=\n' \
    >/etc/systemd/system/cartvod.service.d/v4l2.conf
  systemctl daemon-reload
  cp $configuration "$state/with-ip-cameras.yaml"
  cp $simulation/v4l2-rig.yaml /etc/cartvo/v4l2-rig.yaml
  # The first url is the left camera's; a V4L2 camera has no user name and password.
  sed -i -e '0,/url: rtsp.*/s||url: v4l2:/dev/video0|' -e 's|url: rtsp.*|url: v4l2:/dev/video1|' -e '/^ *username:/d' \
    -e '/^ *password_credential:/d' -e 's|^  # frame_rate: .*|  frame_rate: 5|' -e 's|^rig: .*|rig: v4l2-rig.yaml|' $configuration
}
use_ip_cameras() {
  rm -r /etc/systemd/system/cartvod.service.d
  systemctl daemon-reload
  cp "$state/with-ip-cameras.yaml" $configuration
}
readonly v4l2_timeout=90 # s; long, because emulation on a busy host is slow
doctor_measures_both() { # the streams; the test pictures of vivid do not fit the rig
  local code=0
  timeout 180 cartvo doctor --json >"$state/doctor.json" || code=$?
  if [ $code -gt 4 ] || [ "$(grep -c '"subject": "frame rate"' "$state/doctor.json")" -ne 2 ]; then
    sed 's/^/     | /' "$state/doctor.json"
    return 1
  fi
}
both_stream() { logged 'left camera: streaming' && logged 'right camera: streaming'; }
v4l2_checks() {
  use_v4l2
  mark
  systemctl start --no-block cartvod
  check "V4L2: absent cameras are named" await 150 logged 'left camera: connecting: the camera /dev/video0 .* is it plugged in'
  mark
  check "V4L2: the kernel simulates two cameras" plug_v4l2
  check "V4L2: both stream to the confined service" await $v4l2_timeout both_stream
  check "V4L2: their frames are paired" received 20 no_pair -le 10
  check "V4L2: cartvo doctor finds nothing broken while cartvod runs" doctor_is_content
  local process
  process=$(pid)
  mark
  check "V4L2: one driver can be made to fail" v4l2-ctl -d /dev/video0 -c inject_fatal_streaming_error=1
  # The camera is reopened after half a second, often before the daemon polls its state.
  check "V4L2: a failing driver is named" await $v4l2_timeout logged 'left camera: (connecting|streaming again after .*): the camera /dev/video0'
  check "V4L2: and the camera is reopened" await $v4l2_timeout logged 'left camera: streaming'
  mark
  check "V4L2: the other driver can be made to stop sending" v4l2-ctl -d /dev/video1 -c percentage_of_dropped_buffers=100
  check "V4L2: a driver that stops sending is reported" await $v4l2_timeout logged 'right camera: stalled: .*sent no picture'
  v4l2-ctl -d /dev/video1 -c percentage_of_dropped_buffers=0
  check "V4L2: and the camera is reopened" await $v4l2_timeout logged 'right camera: streaming'
  mark
  check "V4L2: unplugged while in use" unplug_v4l2
  check "V4L2: the unplugged camera is reported" await $v4l2_timeout logged 'left camera: connecting: the camera /dev/video0'
  mark
  check "V4L2: plugged in again" replug_v4l2
  check "V4L2: and both stream" await $v4l2_timeout both_stream
  check "V4L2: the process was not restarted" is MainPID "$process"
  sed -i 's|^    url: v4l2:/dev/video0|&\n    exposure: 0.004|' $configuration
  mark
  systemctl restart --no-block cartvod
  check "V4L2: a control that the camera lacks is named" await $v4l2_timeout logged "left camera: connecting: .*has no control for its exposure"
  systemctl stop cartvod
  sed -i '/^    exposure: 0.004$/d' $configuration
  check "V4L2: cartvo doctor opens both without cartvod" doctor_measures_both
  modprobe -r vivid
  use_ip_cameras
}

# --- links that lose, reorder and delay packets: the kernel's netem

bad_link() { # bad_link NETEM...: on loopback, except for LCM's messages
  good_link
  tc qdisc add dev lo root handle 1: prio bands 2 priomap 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 &&
    tc filter add dev lo parent 1: protocol ip prio 1 u32 match ip dst 239.255.76.67/32 flowid 1:1 &&
    tc qdisc add dev lo parent 1:2 handle 20: netem "$@"
}
good_link() { tc qdisc delete dev lo root 2>/dev/null; }
capture_tolerates_bad_links() { # none of its tests may be skipped
  unshare --net sh -c 'ip link set lo up && exec cartvo_capture_link_tests' >"$state/links" 2>&1
  local status=$?
  grep -E '^(loss|delay|duplicate)|Failure|^\[ .*(FAILED|SKIPPED|PASSED)' "$state/links" | sed 's/^/     | /'
  [ $status -eq 0 ] && ! grep SKIPPED "$state/links" >/dev/null
}
netem_checks() { # with the cameras on
  check "netem: pairs continue over UDP, none with a damaged picture" capture_tolerates_bad_links
  sed -i 's|^  transport: tcp$|  transport: udp|' $configuration
  mark
  systemctl restart --no-block cartvod
  check "netem: odometry over UDP" await 150 logged '^odometry is valid'
  local process link
  process=$(pid)
  for link in 'loss 0.1%' 'loss 1%' 'loss 5%' 'delay 10ms reorder 25% 50%' 'delay 50ms 50ms'; do
    # shellcheck disable=SC2086  # split into words
    check "netem: a link with $link" bad_link $link
    check "netem: valid odometry continues" received 60 valid -ge 3
  done
  good_link
  check "netem: the process was not restarted" is MainPID "$process"
  systemctl stop cartvod
  sed -i 's|^  transport: udp$|  transport: tcp|' $configuration
}

# --- the checks

suit_emulation() { # the emulated processor is slow
  sed -i -e 's|^  stall_timeout: 1$|  stall_timeout: 3|' -e 's|^  features: 1000$|  features: 150|' $configuration
}
set_up() { # the steps of cartvod(8)
  cameras_on || return 1 # the first start creates a rig file and a password
  cameras_off
  tr -d '\n' <"$simulation/password" >"$state/password"
  install -D -m 600 "$state/password" $credentials/left-camera-password
  install -D -m 600 "$state/password" $credentials/right-camera-password
  install -m 644 "$simulation/rig.yaml" /etc/cartvo/rig.yaml
  sed -i -e "s|rtsp://192.168.1.64:554/|rtsp://$left_address:8554/|" -e "s|rtsp://192.168.1.65:554/|rtsp://$right_address:8554/|" \
    -e 's|^  # listen: .*|  listen: 127.0.0.1:9464|' $configuration
  systemctl daemon-reload
  systemctl enable --quiet --now --no-block cartvod
}
waits_for_cameras() { await 60 is SubState start && holds_for 75 is SubState start; }
became_ready_at_validity() { # READY within 2 s of the journal's 'odometry is valid'
  local ready valid
  ready=$(show ActiveEnterTimestampMonotonic)
  valid=$(journal -o short-monotonic | sed -n 's/^\[ *\([0-9]*\)\.\([0-9]*\)\].*odometry is valid$/\1\2/p' | head -n 1)
  [ -n "$valid" ] && [ "$ready" -gt $((valid - 2000000)) ] && [ "$ready" -lt $((valid + 2000000)) ]
}
runs_confined() {
  local status
  status=$(cat "/proc/$(pid)/status")
  [ "$(stat -c %U "/proc/$(pid)")" = cartvo ] && grep -q '^CapEff:\s*0*$' <<<"$status" &&
    grep -q '^CapBnd:\s*0*$' <<<"$status" && grep -q '^NoNewPrivs:\s*1$' <<<"$status" && grep -q '^Seccomp:\s*2$' <<<"$status"
}
has_low_exposure() {
  systemd-analyze security --no-pager "$1" | tail -n 1 | sed 's/^/     | /'
  systemd-analyze security --no-pager --threshold=20 "$1" >/dev/null
}
stopped_cleanly() {
  systemctl stop cartvod && is ActiveState inactive && is Result success && is ExecMainCode 1 && is ExecMainStatus 0 &&
    logged 'stopped after [0-9]+ pairs'
}
logins_are_open() { systemctl -q is-active systemd-user-sessions && systemctl -q is-active getty@tty1; }
fixed_by_its_commands() { # runs the commands quoted in the message
  local commands
  commands=$(journal -o cat | sed -n "s/.*To keep LCM on this host, as root: '\([^']*\)'.*/\1/p" | head -n 1)
  echo "     | $commands"
  [ -n "$commands" ] && sh -ec "$commands"
}

first_boot() {
  mark
  check "the steps of cartvod(8) set it up" set_up
  check "waits for absent cameras longer than TimeoutStartSec without failing" waits_for_cameras
  check "names the camera it waits for" logged 'left camera: connecting: .*127\.0\.0\.1'
  check "publishes INVALID meanwhile" received 5 no_pair -gt 8 valid -eq 0
  check "/healthz says what it waits for" health_says 'waiting for both cameras'

  mark
  cameras_on
  check "becomes ready once the cameras are on" measure_valid "the cameras answer" "$(since_boot_ms)" 120
  check "and systemd counts it as started" await 5 is_active
  check "ready at the first valid odometry, not before" became_ready_at_validity
  check "was not restarted meanwhile" is NRestarts 0
  check "runs as its own user, without capabilities, with a system-call filter" runs_confined
  check "another user receives odometry over LCM" received 45 valid -ge 10 lost -eq 0
  running_checks
  check "a second cartvod refuses to start" second_daemon_is_refused
  local process restarts
  process=$(pid) restarts=$(show NRestarts)
  # The simulated cameras' server would send a day of pictures at once, or none for a day.
  date -s '+1 day' >/dev/null
  cameras_off
  cameras_on
  check "the host's clock is set forward by a day: valid" received 30 valid -ge 10
  date -s '-1 day' >/dev/null
  cameras_off
  cameras_on
  check "the host's clock is set back: valid" received 30 valid -ge 10
  check "the host's clock was set: the same process, no restart" is_same_process "$process" "$restarts"
  check "exposure of cartvod.service at most 2.0" has_low_exposure cartvod.service
  check "exposure of cartvo-multicast.service at most 2.0" has_low_exposure cartvo-multicast.service

  cameras_off
  check "cameras off: INVALID continues" received 20 no_pair -gt 30 valid -le 6
  check "cameras off: the same process, no restart" is_same_process "$process" "$restarts"
  mark
  cameras_on
  check "cameras on again: valid" await 60 logged '^odometry is valid'
  mark
  pull_cable $right_address
  check "one camera's cable pulled: INVALID, no pair" received 15 no_pair -gt 20 valid -le 6
  check "names the camera" await 30 logged 'right camera: (stalled|connecting)'
  mark
  plug_cable $right_address
  check "cable plugged again: valid" await 90 logged '^odometry is valid'
  check "the process was not restarted" is_same_process "$process" "$restarts"

  mark
  local began
  began=$(since_boot_ms)
  kill -9 "$process"
  check "kill -9: restarted and ready again" await 120 is_ready_again "$process" "$restarts"
  check "kill -9: valid again" measure_valid "kill -9" "$began" 10
  process=$(pid) restarts=$(show NRestarts)
  mark
  began=$(since_boot_ms)
  kill -STOP "$process"
  check "stalled process: the watchdog restarts it, ready again" await 150 is_ready_again "$process" "$restarts"
  check "stalled process: valid again" measure_valid "kill -STOP" "$began" 10
  check "stalled process: the journal reports it" logged 'Watchdog timeout'
  upgrade_checks

  check "the search for passwords finds decoys" finds_decoys
  check "the password is in no journal, command line, environment or property" is_not_leaked "$state/password"
  echo "wrong-$RANDOM$RANDOM$RANDOM" >"$state/wrong"
  install -m 600 "$state/wrong" $credentials/left-camera-password
  sed -i 's|^  level: info$|  level: debug|' $configuration
  mark
  systemctl restart --no-block cartvod
  check "wrong password: a message that names camera and user" await 60 logged "left camera: refused: .*127\.0\.0\.1.* refused the user or password \(user 'admin'"
  check "wrong password: waits before it tries again" logged 'trying again in [0-9]+'
  check "wrong password: waiting, not failed" is ActiveState activating
  check "wrong password: not leaked, even with logging.level debug" is_not_leaked "$state/wrong"
  check "the right password is not leaked either" is_not_leaked "$state/password"
  install -m 600 "$state/password" $credentials/left-camera-password
  sed -i 's|^  level: debug$|  level: info|' $configuration
  systemctl stop cartvod

  full_disk_checks
  if [ "$checks" = all ]; then
    netem_checks
    v4l2_checks
  fi

  ip route delete 239.255.76.67/32 dev lo
  mark
  systemctl start --no-block cartvod
  check "no multicast route: a message reports it" await 60 logged 'LCM: this host has no route for the multicast group 239\.255\.76\.67'
  check "no multicast route: the commands in the message fix it" fixed_by_its_commands
  check "and the service starts by itself" await 120 is_active

  mark
  check "a clean stop: exit 0, inactive" stopped_cleanly
  check "stays stopped" holds_for 5 is ActiveState inactive
}

second_boot() {
  journal_mark=''
  check "booted without cameras: the service starts by itself" await 90 is SubState start
  check "booted without cameras: logins do not wait for it" await 60 logins_are_open
  check "booted without cameras: the service keeps waiting" holds_for 5 is SubState start
  cameras_on
  check "ready once the cameras are on, without an operator" await 180 is_active
  check "at the first start" is NRestarts 0
  check "the multicast route exists again" sh -c 'ip route show 239.255.76.67 | grep -q "dev lo"'
  check "odometry is received over LCM" received 45 valid -ge 10
  mark
  check "a clean stop: exit 0, inactive" stopped_cleanly
}

finish() {
  say "$(lines "$state/passed") passed, $(lines "$state/failed") failed"
  systemctl poweroff
}

if [ ! -e "$state/second" ]; then
  say "first boot, systemd $(systemctl --version | sed -n 's/^systemd \([0-9]*\).*/\1/p'), Linux $(uname -r)"
  checks=$(cat $simulation/checks)
  [[ ! $checks =~ all|package ]] || package_checks
  suit_emulation
  if ! [[ $checks =~ all|service ]]; then
    mark
    if [[ $checks == *netem* ]]; then
      check "the steps of cartvod(8) set it up" set_up
      check "the cameras serve" cameras_on
      netem_checks
      cameras_off
    fi
    [[ $checks != *v4l2* ]] || v4l2_checks
    journalctl --no-pager -o short-precise -u 'cartv*' -u cameras >/dev/ttyS2
    finish
    exit
  fi
  first_boot
  touch "$state/second"
  journalctl --no-pager -o short-precise -u 'cartv*' -u cameras >/dev/ttyS2
  systemctl reboot
else
  say "second boot"
  second_boot
  journalctl --no-pager -o short-precise -b -u 'cartv*' -u cameras >/dev/ttyS2
  finish
fi
