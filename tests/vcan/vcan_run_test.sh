#!/bin/bash
# Claims about vcan-run, one a name; CMakeLists.txt registers each as a test of its own.
# Usage: vcan_run_test.sh CLAIM
set -u
vcan_run=$(dirname -- "$(realpath -- "$0")")/vcan-run
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
export VCAN_RUN_DIR=$scratch

refute() {
    echo "FAILED: $*"
    exit 1
}
expect_status() { # expected status, then the command
    local expected=$1 status
    shift
    "$@"
    status=$?
    [ $status = "$expected" ] || refute "status $status instead of $expected of: $*"
}
wait_until() { # deciseconds, then a condition
    local tries=$1
    shift
    until "$@"; do
        [ $((tries--)) -gt 0 ] || return 1
        sleep 0.1
    done
}
guest_processes() { # of this test's guests alone: their kernel line names the scratch directory
    local entry
    for entry in /proc/[0-9]*; do
        tr '\0' ' ' <"$entry/cmdline" | grep -q "linux.uml .*$scratch" && echo "${entry#/proc/}"
    done 2>/dev/null
}
no_guest_left() { [ -z "$(guest_processes)" ]; }

CommandSeesVcanAndItsOutputAndStatusComeBackExactly() {
    for byte in {0..255}; do printf "\\x$(printf %x "$byte")"; done >"$scratch/all-bytes"
    for copy in {1..400}; do cat "$scratch/all-bytes"; done >"$scratch/bytes"
    expect_status 7 "$vcan_run" sh -c "cat '$scratch/bytes'; printf 'no newline' >&2; exec 3>&1
        ip -brief link show vcan0 | grep -q UP || exit 1
        while cansend vcan0 123#DEADBEEF; do sleep 0.05; done &
        candump -n 1 vcan0 | grep -q '123.*DE AD BE EF' || exit 2
        exit 7" >"$scratch/out" 2>"$scratch/err"
    cmp "$scratch/bytes" "$scratch/out" || refute "standard output differs"
    [ "$(<"$scratch/err")" = "no newline" ] || refute "standard error differs: $(<"$scratch/err")"
}

SignalsAndAbsentCommandsHaveTheirShellStatus() {
    expect_status 143 "$vcan_run" -i "" sh -c 'kill -TERM $$'
    expect_status 127 "$vcan_run" -i "" no-such-command 2>"$scratch/err"
    grep -q no-such-command "$scratch/err" || refute "the command is not named: $(<"$scratch/err")"
}

WritesStayInTheGuestExceptWhereAllowed() {
    mkdir "$scratch/real"
    local lost="/etc/${scratch##*/}" # as new as the scratch directory, so that only this run can have made it
    expect_status 0 "$vcan_run" -i "" -w "$scratch/real" sh -c "touch '$lost' '$scratch/lost' && echo kept >'$scratch/real/file'"
    [ ! -e "$lost" ] && [ ! -e "$scratch/lost" ] || { rm -f "$lost"; refute "a write reached the host"; }
    [ "$(<"$scratch/real/file")" = kept ] || refute "a write under -w is not there"
}

OptionsShapeTheGuest() {
    expect_status 0 "$vcan_run" -i can7,can8 -M slcan -S 'ip link set can8 down' -u 1234:4321 bash -c '
        [ "$(id -u):$(id -g)" = 1234:4321 ] && grep -q "^slcan " /proc/modules &&
        ip -brief link show can7 | grep -q UP && ip -brief link show can8 | grep -q DOWN && [ -e <(:) ]'
}

MoreFilesThanTheUsualDescriptorLimitCanBeRead() {
    mkdir "$scratch/many"
    (cd "$scratch/many" && for file in {1..1500}; do echo "$file" >"$file"; done)
    [ "$(ulimit -S -n 1024 && "$vcan_run" -i "" sh -c "cat '$scratch'/many/* | wc -l")" = 1500 ] || refute "files are missing"
}

TimeOutEndsEverythingWithStatus124() {
    expect_status 124 "$vcan_run" -t 3 -i "" sleep 60 2>"$scratch/err"
    grep -q 'timed out after 3 s' "$scratch/err" || refute "no word of the time-out: $(<"$scratch/err")"
    wait_until 50 no_guest_left || refute "processes are left: $(guest_processes)"
}

PanicOfTheGuestIsStatus125() {
    expect_status 125 "$vcan_run" -i "" sh -c 'echo c >/proc/sysrq-trigger' 2>"$scratch/err"
    grep -q 'ended without a status' "$scratch/err" || refute "no word of the panic: $(<"$scratch/err")"
}

WrongUseIsStatus125() {
    expect_status 125 "$vcan_run" 2>/dev/null
    expect_status 125 "$vcan_run" -t soon true 2>/dev/null
    expect_status 125 "$vcan_run" -w "$scratch/absent" true 2>/dev/null
    expect_status 125 "$vcan_run" -M no-such-module true 2>/dev/null
}

KilledWrapperLeavesNothingBehind() {
    mkdir "$scratch/real"
    "$vcan_run" -t 60 -i "" -w "$scratch/real" sh -c "touch '$scratch/real/started'; sleep 60" &
    local wrapper=$!
    wait_until 300 test -e "$scratch/real/started" || refute "the guest never started"
    kill -KILL $wrapper
    wait $wrapper 2>/dev/null
    wait_until 50 no_guest_left || refute "processes are left: $(guest_processes)"
    wait_until 50 eval '[ -z "$(ls -d "$scratch"/vcan-run.* 2>/dev/null)" ]' || refute "scratch files are left"
}

SystemdRunsAsPid1AndNetworkdSetsUpTheBus() {
    printf '%s\n' '[NetDev]' 'Name=vcan5' 'Kind=vcan' >"$scratch/10-vcan5.netdev"
    printf '%s\n' '[Match]' 'Name=vcan5' '[Link]' 'RequiredForOnline=no' >"$scratch/10-vcan5.network"
    expect_status 9 "$vcan_run" -s -i "" -U "$scratch/10-vcan5.netdev" -U "$scratch/10-vcan5.network" bash -c '
        [ "$(cat /proc/1/comm)" = systemd ] || exit 1
        for try in {1..50}; do networkctl status vcan5 | grep -q "State: .*configured" && exit 9; sleep 0.2; done
        networkctl status vcan5; exit 2'
}

declare -F -- "${1:-}" >/dev/null && [[ $1 =~ ^[A-Z] ]] || refute "no such claim: ${1:-}"
"$1"
