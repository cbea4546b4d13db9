#!/usr/bin/env bash
# A study on a cluster: Debian's Slurm with a controller and a node of two CPUs on this machine. The rows are the same as with one
# or two threads; and whatever happens to slices (killed, failed, cancelled, run twice at once, truncated), resuming submits exactly
# the slices missing on disk and gives the same rows.
#   slurm_study.sh OSTEOMILL BALL.SH [SEEDS]   with four trials per seed; a multiple of 3
set -euo pipefail
osteomill=$1 ball=$2 seeds=${3:-6}
. "$(dirname "${BASH_SOURCE[0]}")/study_rows.sh"
trials=$((4 * seeds))

PATH=$PATH:/usr/sbin
installed() { command -v slurmctld && command -v slurmd && command -v sbatch; } >/dev/null
installed || { [ "$(id -u)" = 0 ] && apt-get install -y slurmctld slurmd slurm-client >/dev/null 2>&1; } || true
installed || { echo "SKIPPED: needs slurmctld, slurmd and slurm-client, which cannot be installed here"; exit 77; }
[ "$(id -u)" = 0 ] || { echo "SKIPPED: a Slurm of one's own needs root"; exit 77; }

folder=$(mktemp -d)
daemons=()
finish() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  wait || true
  rm -rf "$folder"
}
trap finish EXIT
cd "$folder"
fault() { echo "FAILED: $1"; tail -n 20 ./*.log out*/logs/* 2>/dev/null || true; exit 1; }
free_port() {
  local port=$((20000 + RANDOM % 20000))
  while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
  echo "$port"
}
until_true() {  # SECONDS COMMAND...
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$deadline" ] || return 1
    sleep 0.2
  done
}

export SLURM_CONF=$folder/slurm.conf
mkdir state spool
cat >slurm.conf <<CONF
ClusterName=here
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2,batch_sched_delay=1
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
MaxArraySize=4
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
NodeName=here NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=here Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -D -c >slurmctld.log 2>&1 &
daemons+=($!)
slurmd -D -c -N here >slurmd.log 2>&1 &
daemons+=($!)
idle() { sinfo -h -o %t 2>/dev/null | grep -q idle; }
until_true 20 idle || fault "the cluster did not become idle"
nothing_queued() { [ -z "$(squeue -h 2>/dev/null)" ]; }
started() { [ -e "$1" ]; }

bash "$ball" >ball.nrrd
cat >study.toml <<TOML
[fixed]
scan = "ball.nrrd"
iso = 750
burr-radius = 1
shaft-radius = 0.5
seconds = 1
draw-hand = true
[grid]
algorithm = ["line-proxy", "point-shell"]
push = [0.5, 1.5]
seed = {from = 1, to = $seeds, steps = $seeds}
TOML
"$osteomill" study study.toml --out out1 --slices 1 --threads 1 --quiet >/dev/null
rows out1 >expected
[ "$(wc -l <expected)" -eq $((1 + 2 * trials)) ] || fault "there should be a head and two rows for each of $trials trials"
"$osteomill" study study.toml --out out2 --slices 5 --threads 2 --quiet >/dev/null
rows out2 | cmp - expected || fault "two threads give other rows than one"

# Six slices need several arrays, because the cluster's limit is 4.
"$osteomill" study study.toml --out out3 --slices 6 --on slurm >submitted
[ "$(grep -c "^submitted as job" submitted)" -eq 2 ] || fault "6 slices should be two arrays: $(cat submitted)"
until_true 60 nothing_queued || fault "the arrays do not end"
rows out3 | cmp - expected || fault "the cluster gives other rows than one thread"
"$osteomill" study out3 --status | grep -q "^$trials of $trials trials are done (100 %), 6 of 6 slices$" || fault "not all is done"

# Faults of slices. Users may edit submit.sh.
mkdir out4
cp out3/submit.sh whole.sh
sed '/^exec/i\
case $slice in\
  1) "'"$osteomill"'" study '"$folder"'/out4 --slice 1 --quiet & sleep 0.05; kill -9 $!; kill -9 $$ ;;\
  2) exit 1 ;;\
  3) touch '"$folder"'/started3; sleep 100 ;;\
esac' whole.sh >out4/submit.sh
"$osteomill" study study.toml --out out4 --slices 6 --on slurm >submitted
job=$(sed -n '1s/.* //p' submitted)
sbatch --parsable --chdir="$folder/out4" --array=0 out4/submit.sh 4 >/dev/null
"$osteomill" study out4 --slice 4 --threads 1 --quiet
until_true 30 started started3 || fault "slice 3 did not start"
scancel "${job}_3"
until_true 60 nothing_queued || fault "the arrays with faults do not end"
truncate -s -500 out4/slice-0.h5
"$osteomill" study out4 --status >status || fault "no status"
grep -q "^$((trials / 3)) of $trials trials are done (33.3 %), 2 of 6 slices$" status || fault "status: $(cat status)"
grep -q "^left: slices 0-3, " status || fault "status: $(cat status)"
grep -q "slice-0.h5 cannot be used" status || fault "the truncated file is not reported"
"$osteomill" study out4 --report >/dev/null
grep -q "covers a part of the study" out4/report/report.html && grep -q "$((trials / 3)) of $trials trials (33.3 %)" out4/report/report.html ||
  fault "the report does not state that it is partial"
cp whole.sh out4/submit.sh
stat -c %Y.%i out4/slice-[45].h5 >before
rm -f out4/logs/*
"$osteomill" study out4 --resume --on slurm >submitted
until_true 60 nothing_queued || fault "the resumed arrays do not end"
[ "$(ls out4/logs | wc -l)" -eq 4 ] || fault "four slices were missing, these ran: $(ls out4/logs)"
stat -c %Y.%i out4/slice-[45].h5 | cmp - before || fault "slices that were done ran again"
rows out4 | cmp - expected || fault "the rows differ after the faults"
[ "$("$osteomill" study out4 --resume --on slurm)" = out4 ] || fault "there was nothing to submit"

# A moved folder.
mkdir elsewhere
mv out4 elsewhere/moved
rm elsewhere/moved/slice-2.h5
"$osteomill" study elsewhere/moved --resume --on slurm >submitted
until_true 60 nothing_queued || fault "the arrays of the moved study do not end"
rows elsewhere/moved | cmp - expected || fault "a moved study cannot be resumed"
mv elsewhere/moved out4

# A refusal of the cluster is reported with its reason, and a missing sbatch in one line.
rm out4/slice-2.h5
sed -i 's/^##SBATCH --partition=.*/#SBATCH --partition=nowhere/' out4/submit.sh
code=0
"$osteomill" study out4 --resume --on slurm 2>refused || code=$?
sed -i "/ warning: /d" refused
[ $code -eq 1 ] && [ "$(wc -l <refused)" -eq 1 ] && grep -q "invalid partition specified: nowhere\|Invalid partition name" refused ||
  fault "a refusal: $code, $(cat refused)"
code=0
PATH=/nowhere "$osteomill" study study.toml --out out5 --on slurm 2>refused || code=$?
[ $code -eq 1 ] && grep -q "^osteomill: sbatch: is not installed" refused && [ ! -e out5 ] || fault "without sbatch: $code, $(cat refused)"
exit 0
