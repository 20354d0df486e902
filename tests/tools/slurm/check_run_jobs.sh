#!/usr/bin/env bash
# check_run_jobs.sh SOURCE CARTVO: tools/slurm/run_jobs on a Slurm of one node, from Debian's packages: the jobs of lab/lab
# give the table of a single run, and a job that fails is named. Exits with 77 (skipped) without Slurm or namespaces.
set -euo pipefail
if [ "${3-}" != inside ]; then
  for program in slurmctld slurmd munged sbatch; do
    command -v $program >/dev/null || { echo "skipped: $program is not installed" && exit 77; }
  done
  if [ "$(id -u)" -ne 0 ] || ! unshare --mount --net --uts --pid --fork true; then
    echo "skipped: needs root and namespaces" && exit 77
  fi
  # With this script end all programs that it has started.
  exec unshare --mount --net --uts --pid --fork --mount-proc --kill-child "$(realpath "$0")" "$(realpath "$1")" "$(realpath "$2")" inside
fi
lab=$1/lab/lab run_jobs=$1/tools/slurm/run_jobs cartvo=$2 make_sequence=$(dirname "$(realpath "$0")")/../../support/tools/make_still_sequence.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
chmod 755 "$folder"
cd "$folder"
PATH=$(dirname "$cartvo"):$PATH
fail() {
  echo "check_run_jobs: $*" >&2
  tail -n 20 ./*.log job_lines.log/* >&2 || true
  exit 1
}
await() { # WHAT COMMAND ...
  local end=$((SECONDS + 60))
  until "${@:2}" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || fail "after 60 s: not seen: $1"
    sleep 0.2
  done
}

# A cluster: this computer, named localhost.
hostname localhost
ip link set lo up
# Slurm resolves names only where there is an address besides the loopback's.
ip link add port type veth peer name other
ip address add 192.0.2.1/24 dev port
ip link set port up
mkdir state spool munge
dd if=/dev/urandom of=munge/key bs=64 count=1 status=none
chmod 700 munge && chmod 600 munge/key
munged --force --foreground --socket="$folder/munge.socket" --key-file=munge/key --pid-file="$folder/munge/pid" \
  --seed-file="$folder/munge/seed" --log-file="$folder/munged.log" 2>munged.err &
cat >slurm.conf <<CONF
ClusterName=check
SlurmctldHost=localhost
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
ReturnToService=2
MpiDefault=none
NodeName=localhost NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
await 'munged' munge --socket="$folder/munge.socket" --no-input
slurmctld -D 2>/dev/null &
slurmd -D -N localhost 2>/dev/null &
is_idle() { [ "$(sinfo --noheader --format=%T)" = idle ]; }
await 'a node that is idle' is_idle

# Two sequences of pictures in which nothing moves.
"$make_sequence" data/near_still 16
"$make_sequence" data/far_still 8

options=(--cartvo "$cartvo" --data data --scenarios none --estimators reprojection --cache-dir cache)
"$lab" accuracy "${options[@]}" --list results >job_lines
"$run_jobs" job_lines --parallel 2 --then "$lab accuracy --merge results" >merged || fail "the jobs failed"
"$lab" accuracy "${options[@]}" >whole 2>/dev/null
# All columns but the times.
# The time of a pair stands before the four columns of validity.
without_times() { sed -E 's/ +[0-9.]+ \/ +[0-9.]+(( +[^ ]+){4})$/\1/' "$1"; }
grep -q far_still merged || fail "$(cat merged)"
diff <(without_times merged) <(without_times whole) >&2 || fail "the merged table is another one"

# A job that fails: it is named, the others have run, and what follows does not.
printf '%s\n' 'echo one > one' '' 'echo two; false' 'echo three > three' >job_lines
code=0
"$run_jobs" job_lines --log logs --then 'touch after' 2>errors || code=$?
if [ $code -ne 1 ] || ! grep -q 'run_jobs: 1 of 3 lines failed: 2$' errors; then fail "exit code $code: $(cat errors)"; fi
if [ ! -e one ] || [ ! -e three ] || [ -e after ] || [ "$(cat logs/2.log)" != two ]; then fail "$(ls . logs)"; fi
echo "check_run_jobs: in order"
