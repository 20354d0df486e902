# Checks of the installed package, its network files, its web pages, and of passwords and disks, for in_vm.sh, which sources it.
# shellcheck shell=bash disable=SC2154  # in_vm.sh sets the places and has the helpers

# --- the package

is_installed_but_off() { # as apt install leaves it
  [ "$(dpkg-query -W -f "\${db:Status-Status}" cartvo)" = installed ] && ! dpkg --verify cartvo | grep -v ' c /etc/' &&
    ! systemctl -q is-enabled cartvod && ! systemctl -q is-active cartvod
}
has_its_user() {
  local id
  id=$(id -u cartvo) && [ "$id" -gt 0 ] && [ "$id" -lt 1000 ] && grep -q '^cartvo:.*:/usr/sbin/nologin$' /etc/passwd
}
refuses_to_start_unconfigured() { # the configuration as delivered lacks the rig
  local code=0
  cartvod --config "$configuration" --check-config >"$state/unconfigured" 2>&1 || code=$?
  [ $code -eq 2 ] && grep -q 'not calibrated yet' "$state/unconfigured"
}

# --- the ports of the cameras, by cartvo camera network

has_address() { ip -4 -o addr show dev "$1" | grep -q " $2 "; }
writes_the_example_files() {
  cartvo camera network --left-interface enp2s0 --right-interface enp3s0 --left-camera 192.168.101.64 --right-camera 192.168.102.64 \
    --dhcp --output-dir /etc >"$state/network" || return 1
  sed 's/^/     | /' "$state/network"
  local file
  for file in systemd/network/10-cartvo-{left,right}.network chrony/conf.d/cartvo-cameras.conf sysctl.d/60-cartvo-buffers.conf; do
    cmp "/etc/$file" "/usr/share/cartvo/network/${file##*/}" || return 1
  done
}
brings_up_the_ports() { # two ports, one of them without a camera
  ip link add enp2s0 type veth peer name camera && ip link set camera up && ip link add enp3s0 type veth peer name absent || return 1
  systemctl start systemd-networkd
  await 60 has_address enp2s0 192.168.101.1/24 && await 30 has_address enp3s0 192.168.102.1/24 &&
    timeout 60 /lib/systemd/systemd-networkd-wait-online && [ -z "$(ip route show default)" ]
}
is_configured_by() { networkctl --no-pager status "$1" | grep "Network File: $2" >/dev/null && networkctl --no-legend list "$1" | grep configured >/dev/null; }
networkd_understands_each_line() { ! journalctl -b --no-pager -o cat -u systemd-networkd | grep '\.network:[0-9]'; }
changes_to_one_port() { # both cameras at one switch: by networkctl reload, without a restart
  rm -f /etc/systemd/network/10-cartvo-*
  cartvo camera network --interface enp2s0 --left-camera 192.168.103.64 --right-camera 192.168.103.65 --output-dir /etc --force >/dev/null &&
    networkctl reload && await 60 has_address enp2s0 192.168.103.1/24 && [ -z "$(ip route show default)" ]
}
refuses_an_overlap() {
  ! cartvo camera network --interface camera --left-camera 192.168.103.66 --right-camera 192.168.103.67 --output-dir /tmp/overlap \
    2>"$state/overlap" && grep 'overlaps 192.168.103.1/24 of enp2s0' "$state/overlap" >/dev/null && [ ! -e /tmp/overlap ]
}
sets_the_buffers() {
  systemctl restart systemd-sysctl && [ "$(cat /proc/sys/net/core/rmem_max)" = 4194304 ]
}
remove_the_ports() {
  systemctl stop systemd-networkd.socket systemd-networkd
  rm -f /etc/systemd/network/10-cartvo-* /etc/chrony/conf.d/cartvo-cameras.conf
  ip link delete enp2s0
  ip link delete enp3s0
}
package_checks() {
  check "apt installed the package, and nothing runs" is_installed_but_off
  check "the package created the service's user" has_its_user
  check "without a calibration the configuration is refused" refuses_to_start_unconfigured
  check "cartvo camera network writes the example files" writes_the_example_files
  check "they bring up both ports, also without a camera" brings_up_the_ports
  check "networkctl names the file of the left port" is_configured_by enp2s0 /etc/systemd/network/10-cartvo-left.network
  check "networkctl names the file of the right port" is_configured_by enp3s0 /etc/systemd/network/10-cartvo-right.network
  check "they set the receive buffers" sets_the_buffers
  check "both cameras at one port: networkctl reload changes it" changes_to_one_port
  check "a network that overlaps another one is refused" refuses_an_overlap
  check "networkd understands each line" networkd_understands_each_line
  remove_the_ports
}

# --- /metrics, /healthz, reload, doctor

get() { # get PATH: status line and body
  local line
  exec 3<>/dev/tcp/127.0.0.1/9464 || return 1
  printf 'GET %s HTTP/1.0\r\nHost: localhost\r\n\r\n' "$1" >&3
  while IFS= read -r line <&3; do printf '%s\n' "$line"; done
  exec 3>&-
}
serves_metrics() { get /metrics | grep -E '^cartvo_[a-z_]+(\{[^}]*\})? [0-9]' >/dev/null; }
health_says() { get /healthz | grep "$1" >/dev/null; }
reloads() { # reload with an edited configuration
  sed -i "$1" "$configuration"
  systemctl reload cartvod
}
not() { ! "$@"; }
doctor_is_content() { # 3: something to look at, such as the small pictures here
  local code=0
  timeout 120 cartvo doctor >"$state/doctor" 2>&1 || code=$?
  sed 's/^/     | /' "$state/doctor"
  [ $code -eq 0 ] || [ $code -eq 3 ]
}
journal_finds() { journalctl -b --no-pager -u cartvod "$@" | grep -E '(left|right) camera: |odometry is |self-check: ' >/dev/null; }
running_checks() { # with valid odometry
  check "the journal finds changes of validity by their fields" journal_finds CARTVO_EVENT=odometry_validity CARTVO_ODOMETRY_STATUS=valid
  check "the journal finds a camera's states by their fields" journal_finds CARTVO_EVENT=camera_state CARTVO_CAMERA=left CARTVO_CAMERA_STATE=streaming
  check "the journal finds nothing by a value that no line has" not journal_finds CARTVO_EVENT=camera_state CARTVO_CAMERA=middle
  check "/metrics has values" await 10 serves_metrics
  check "/healthz is 200 with valid odometry" await 10 health_says '^HTTP/1.1 200 '
  mark
  check "systemctl reload with another time to live" reloads 's|^  time_to_live: .*|  time_to_live: 0.4|'
  check "and the change is in force" await 20 logged 'time_to_live'
  cp "$configuration" "$state/before-the-error"
  check "systemctl reload with an error" reloads '1i no_such_key: 1'
  check "and the old configuration stays in force" await 20 logged 'the old one stays in force'
  cp "$state/before-the-error" "$configuration"
  check "odometry went on" is_active
  check "cartvo doctor finds nothing broken while cartvod runs" doctor_is_content
}
second_daemon_is_refused() {
  local code=0
  timeout 30 cartvod --config "$configuration" >"$state/second-daemon" 2>&1 || code=$?
  [ $code -eq 1 ] && grep -q "another cartvod (process $(pid)) publishes CARTVO_ODOMETRY" "$state/second-daemon"
}

# --- times

since_boot_ms() { local up; read -r up _ </proc/uptime; echo $((${up/./} * 10)); }
measure_valid() { # measure_valid DESCRIPTION START-MS SECONDS: waits for the next valid odometry, and prints the time since START-MS
  await "$3" logged '^odometry is valid' || return 1
  local valid
  valid=$(journal -o short-monotonic | sed -n 's/^\[ *\([0-9]*\)\.\([0-9]\{3\}\).*odometry is valid$/\1\2/p' | head -n 1)
  echo "     | $1: valid after $((valid - $2)) ms (emulated processor)"
}

# --- an upgrade of the running service

make_newer_packages() { # the installed package with newer versions
  local folder=/var/tmp/newer version
  rm -rf $folder && dpkg-deb -R "$simulation/cartvo.deb" $folder || return 1
  for version in 1 2; do
    sed -i "s/^Version: .*/Version: 99.$version/" $folder/DEBIAN/control
    dpkg-deb --root-owner-group -Zgzip -z1 -b $folder "/var/tmp/newer-$version.deb" >/dev/null || return 1
  done
  rm -r $folder
}
upgrade_to() { dpkg --force-confold -i "/var/tmp/newer-$1.deb" >"$state/upgrade" 2>&1; }
upgrade_checks() { # with valid odometry
  local process began
  check "upgrade: newer packages" make_newer_packages
  process=$(pid)
  mark
  began=$(since_boot_ms)
  check "upgrade: dpkg does not wait for cameras" upgrade_to 1
  check "upgrade: by another process" await 60 not is MainPID "$process"
  mark # what the old process logged does not count
  check "upgrade: valid again" measure_valid "upgrade" "$began" 120
  process=$(pid)
  cp "$configuration" "$state/before-the-error"
  sed -i '1i no_such_key: 1' "$configuration"
  check "upgrade with a configuration that is refused" upgrade_to 2
  check "upgrade: says so" grep -q 'the new version does not accept the configuration' "$state/upgrade"
  check "upgrade: the old process runs on" is MainPID "$process"
  cp "$state/before-the-error" "$configuration"
}

# --- a full disk

use_a_small_disk() {
  mkdir -p /var/lib/cartvo/full
  mount -t tmpfs -o "size=200k,uid=$(id -u cartvo),mode=700" tmpfs /var/lib/cartvo/full
  cp "$configuration" "$state/before-full-disk"
  sed -i -e 's|^  # directory: /var/lib/cartvo/recordings|  directory: /var/lib/cartvo/full|' -e 's|^  keep_free: .*|  keep_free: 0|' "$configuration"
  systemctl restart --no-block cartvod
}
full_disk_checks() {
  mark
  check "full disk: cartvod records onto a disk of 200 kB" use_a_small_disk
  check "full disk: a message names it" await 120 logged 'recording stopped: .*No space left on device'
  check "full disk: odometry continues" received 30 valid -ge 5
  check "full disk: no restart" is NRestarts 0
  systemctl stop cartvod
  umount /var/lib/cartvo/full
  cp "$state/before-full-disk" "$configuration"
}

# --- places where a password could leak

leaks_of() { # leaks_of FILE: names the places where the password in FILE can be read
  journalctl --no-pager -a -o export | grep -aFf "$1" >/dev/null && echo journal
  systemctl show cartvod cartvo-multicast | grep -aFf "$1" >/dev/null && echo "properties of the units"
  grep -alFf "$1" /proc/[0-9]*/cmdline /proc/[0-9]*/environ 2>/dev/null
}
finds_decoys() { # checks the search itself with decoys in plain sight
  local decoy=decoy-$RANDOM$RANDOM found
  echo "$decoy" >"$state/decoy"
  DECOY=$decoy sleep 600 &
  local with_environment=$!
  bash -c 'sleep 600; :' "$decoy" &
  local with_argument=$!
  logger "$decoy"
  await 10 sh -c "journalctl -n 50 -o cat | grep -qF '$decoy'"
  found=$(leaks_of "$state/decoy")
  kill $with_environment $with_argument
  [[ $found == *journal* && $found == */proc/$with_environment/environ* && $found == */proc/$with_argument/cmdline* ]]
}
is_not_leaked() {
  [ -s "$1" ] && [ "$(wc -c <"$1")" -ge 6 ] || return 1
  local found
  found=$(leaks_of "$1")
  [ -z "$found" ] || { echo "     | password in: ${found//$'\n'/, }"; return 1; }
}
