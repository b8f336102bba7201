#!/usr/bin/env bash
# Shares under Slurm: a node that dies in the middle, a share that fails at first, a share and a preparation that fail for
# good. Run by CTest as
#     farm_slurm.sh LAMBENT LAMBENT_DEMO_LEVEL OUTPUT FOLDER
# Starts a Slurm of three nodes of its own: in namespaces of processes and network, so that nothing outside sees it, its
# nodes die whole, and nothing of it outlives the test. Skips (77) where there is no Slurm, or no right to do that.
set -euo pipefail

skip() {
    echo "skipped: $1"
    exit 77
}

if [[ "${1-}" != --inside ]]; then
    for program in slurmctld slurmd sbatch squeue scontrol unshare ip timeout; do
        command -v "$program" >/dev/null || PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || skip "no $program"
    done
    spaces=(unshare --net --pid --fork --kill-child --mount-proc)
    "${spaces[@]}" ip link set lo up 2>/dev/null || skip "no right to make namespaces"
    # Not below the output folder: Slurm's sockets have room for short names.
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    timeout --kill-after=5 560 "${spaces[@]}" bash "$0" --inside "$work" "$@"
    exit
fi

work=$2
real=$3
demo_level=$4
output=$5
farm=$(cd "$(dirname "$0")/../tools/farm" && pwd)
PATH=$PATH:/usr/sbin
nodes=(n1 n2 n3)
export SLURM_CONF=$work/slurm.conf
unset "${!SBATCH_@}" "${!LAMBENT_@}"

fail() {
    echo "failed: $1"
    tail -n +1 "$work"/runs.*
    echo "-- queue"
    squeue || true
    tail -n 20 "$work"/*.log "$output"/bake/*.log 2>/dev/null || true
    exit 1
}

# wait_for SECONDS WHAT COMMAND...: until the command is true
wait_for() {
    local seconds=$1 what=$2
    shift 2
    for ((i = 0; i < 5 * seconds; ++i)); do
        if "$@"; then
            return
        fi
        sleep 0.2
    done
    fail "no $what in $seconds s"
}

slurm_start() {
    local host node port=17001
    host=$(uname -n)
    host=${host%%.*}
    ip link set lo up
    ip address add 10.77.0.1/32 dev lo # getaddrinfo gives no address where there is only 127.0.0.1
    mkdir "$work/state"
    cat >"$SLURM_CONF" <<EOF
ClusterName=farm
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
# A job of a dead node runs again no sooner than its credential expires, 120 s unless said.
AuthInfo=cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
SlurmdSpoolDir=$work/%n
StateSaveLocation=$work/state
SlurmdTimeout=4
KillWait=1
SchedulerParameters=sched_interval=1,batch_sched_delay=0
PartitionName=all Nodes=$(IFS=,; echo "${nodes[*]}") Default=YES MaxTime=10 State=UP
EOF
    for node in "${nodes[@]}"; do
        mkdir "$work/$node"
        echo "NodeName=$node NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port++)) CPUs=1" >>"$SLURM_CONF"
    done
    slurmctld -D >"$work/slurmctld.log" 2>&1 &
    for node in "${nodes[@]}"; do
        unshare --pid --fork --kill-child --mount-proc slurmd -D -N "$node" >"$work/$node.log" 2>&1 &
        init[${node#n}]=$!
        disown # its death is no news
    done
    wait_for 60 "idle nodes" nodes_are_idle
}

nodes_are_idle() {
    if grep -qi "cannot find auth plugin\|unknown.*auth/none" "$work/slurmctld.log"; then
        skip "this Slurm has no auth/none"
    fi
    [[ "$(sinfo --noheader --format=%D:%t 2>/dev/null)" == "${#nodes[@]}:idle" ]]
}

# What the jobs run for lambent. Notes who runs what where in $RUNS; and a run fails that is a line of $RUNS.fail, each
# line once. A run is the command and its share, 0 for what is no share.
program_make() {
    cat >"$work/lambent" <<EOF
#!/bin/sh
run="\$1 \${SLURM_ARRAY_TASK_ID:-0}"
echo "\${SLURMD_NODENAME:-none} \$run \${SLURM_RESTART_COUNT:-0}" >>"\$RUNS"
if grep -qx "\$run" "\$RUNS.fail"; then
    sed -i "0,/^\$run\\\$/{//d}" "\$RUNS.fail"
    exit 1
fi
exec "$real" "\$@"
EOF
    chmod +x "$work/lambent"
    export LAMBENT=$work/lambent
}

# runs_fail NAME RUN...: the jobs queued from here on note their runs under this name, and these fail
runs_fail() {
    export RUNS=$work/runs.$1
    shift
    : >"$RUNS"
    printf '%s\n' "$@" >"$RUNS.fail"
}

queue_is_empty() {
    [[ -z "$(squeue --noheader 2>&1)" ]]
}

# A share that runs on the node and has kept a part. Sets `dying`.
share_is_in_the_middle() {
    dying=$(squeue --noheader --states=RUNNING --nodelist="$1" --format=%K 2>/dev/null) || return 1
    [[ "$dying" =~ ^[0-9]+$ ]] && parts_of "$dying" | grep -q .
}

# Name, inode and time of each finished part of a share: one that is written anew is another file.
parts_of() {
    find "$output/bake/share$1/.lambent-parts" -name '*.part' -printf '%f %i %T@\n' 2>/dev/null | sort
}

a_node_dies() {
    runs_fail node "bake 3"
    "$farm/slurm" 4 "$output/bake" "$output/demo.glb" "${effort[@]}"
    wait_for 120 "share in the middle on n2" share_is_in_the_middle n2
    kill -KILL "${init[2]}"
    parts_of "$dying" >"$work/kept"
    echo "n2 dies with share $dying, which has kept $(wc -l <"$work/kept") parts"
    wait_for 200 "end of the jobs" queue_is_empty

    grep -q " bake $dying 1\$" "$RUNS" || fail "share $dying was not queued again"
    if grep -q "^n2 bake $dying 1\$" "$RUNS"; then
        fail "share $dying ran again on the dead node"
    fi
    parts_of "$dying" >"$work/parts"
    [[ -z "$(comm -23 "$work/kept" "$work/parts")" ]] || fail "share $dying began anew"
    [[ $(wc -l <"$work/kept") -lt $(wc -l <"$work/parts") ]] || fail "share $dying was not in the middle"
    [[ $(grep -c ' bake 3 ' "$RUNS") -ge 2 ]] || fail "share 3 was not tried again"
    [[ $(grep -c ' merge 0 ' "$RUNS") == 1 ]] || fail "the merge did not run once"
    for file in probes.lmb probes.vdb $(cd "$output/whole" && ls -d lightmap/*); do
        cmp "$output/whole/$file" "$output/bake/$file" || fail "$file is not that of one bake"
    done
    echo "ok   a node dies, its share goes on elsewhere, the same bytes"
}

# Both at once: they wait for nothing of each other's.
a_job_fails_for_good() {
    export LAMBENT_TRIES=2
    runs_fail prepare
    "$farm/slurm" 2 "$output/unprepared" "$output/no_level.glb"
    runs_fail share "bake 1" "bake 1"
    "$farm/slurm" 2 "$output/failed" "$output/demo.glb" --spacing 2 --samples 16
    wait_for 100 "end of the jobs" queue_is_empty

    [[ $(grep -c ' bake 0 ' "$work/runs.prepare") == 2 ]] || fail "the preparation was not tried twice"
    if grep -v ' bake 0 ' "$work/runs.prepare" || [[ -e "$output/unprepared/share1" ]]; then
        fail "something ran without the preparation"
    fi
    echo "ok   the preparation fails for good, and shares and merge leave the queue"

    [[ $(grep -c ' bake 0 ' "$RUNS") == 1 ]] || fail "the preparation was not done once"
    [[ $(grep -c ' bake 1 ' "$RUNS") == 2 ]] || fail "share 1 was not tried twice"
    [[ $(grep -c ' bake 2 ' "$RUNS") == 1 ]] || fail "share 2 was not baked"
    if grep -q ' merge ' "$RUNS" || [[ -e "$output/failed/probes.lmb" ]]; then
        fail "merged without a share"
    fi
    echo "ok   a share fails for good, and the merge leaves the queue"
}

effort=(--spacing 0.5 --samples 128 --lightmaps --texels-per-m 8)
rm -rf "$output"
mkdir -p "$output"
"$demo_level" "$output/demo.glb"
"$real" bake "$output/demo.glb" -o "$output/whole" --quiet "${effort[@]}"
program_make
slurm_start
a_node_dies
a_job_fails_for_good
