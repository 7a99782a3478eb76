#!/bin/bash
# Claims about the systemd units as `cmake --install` places them, one a name; CMakeLists.txt registers each as a test.
# Usage: units_test.sh CLAIM BUILD_DIR
set -u
claim=${1:-} build=${2:-}
repository=$(realpath -- "$(dirname -- "$0")/../..")
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
units=(steadyboom-controller.service steadyboom-can@can0.service steadyboom-telemetry.service steadyboom-command.socket)

refute() {
    echo "FAILED: $*"
    exit 1
}
install_into_stage() {
    stage=$scratch/root
    DESTDIR=$stage cmake --install "$build" --prefix /usr >"$scratch/install.log" 2>&1 ||
        { cat "$scratch/install.log"; refute "cmake --install"; }
    installed=$stage/usr/lib/systemd/system
}

# Not the exit status alone: an unknown key is a line of output and status 0.
verify() { systemd-analyze verify --root="$stage" "${units[@]}" 2>&1 || echo "status $?"; }

UnitsPassSystemdsVerificationWithTheInstalledPrograms() {
    install_into_stage
    cp -rn /usr/lib/systemd/system "$stage/usr/lib/systemd/"
    local complaints
    complaints=$(verify)
    [ -z "$complaints" ] || refute "$complaints"

    rm "$stage/usr/bin/steadyboom-controller"
    verify | grep -q 'steadyboom-controller is not executable' || refute "a missing program passed"
}

exposure_within() { # tenths, unit file
    systemd-analyze security --offline=true --threshold="$1" "$2"
}
ExposureStaysWithinItsLimits() {
    install_into_stage
    exposure_within 8 "$installed/steadyboom-controller.service" || refute "the controller is exposed above 0.8"
    exposure_within 10 "$installed/steadyboom-telemetry.service" || refute "the telemetry is exposed above 1.0"
    exposure_within 11 "$installed/steadyboom-can@.service" || refute "the link supervisor is exposed above 1.1"
}
LostProtectionExceedsTheExposureLimit() {
    install_into_stage
    sed -i '/^PrivateUsers=/d' "$installed"/*.service
    ! exposure_within 8 "$installed/steadyboom-controller.service" >/dev/null || refute "the controller's limit has slack"
    ! exposure_within 10 "$installed/steadyboom-telemetry.service" >/dev/null || refute "the telemetry's limit has slack"
    sed -i '/^NoNewPrivileges=/d' "$installed/steadyboom-can@.service"
    ! exposure_within 11 "$installed/steadyboom-can@.service" >/dev/null || refute "the link supervisor's limit has slack"
}

EveryAccountThatAUnitNamesIsMade() {
    install_into_stage
    mkdir -p "$stage/etc"
    systemd-sysusers --root="$stage" "$stage/usr/lib/sysusers.d/steadyboom.conf" || refute "systemd-sysusers"
    local user group
    for user in $(sed -n 's/^User=//p' "$installed"/steadyboom-*); do
        grep -q "^$user:" "$stage/etc/passwd" || refute "user $user"
    done
    for group in $(sed -n 's/^\(Socket\)\?Group=//p' "$installed"/steadyboom-*); do
        grep -q "^$group:" "$stage/etc/group" || refute "group $group"
    done
}

# On a vcan with a real bus's name: it takes the queue length, and has no bit rate to take.
BusIsSetUpByNetworkdWithAShortSendQueue() {
    "$repository/tests/vcan/vcan-run" -t 100 -s -i "" -U "$repository/systemd/80-can.network" \
        -U "$repository/systemd/80-can.link" bash -c '
        ip link add can0 type vcan
        for try in {1..50}; do
            ip link show can0 | grep -qw "qlen 5" && networkctl status can0 | grep -q "Network File: .*/80-can.network" && break
            sleep 0.2
        done
        ip link show can0 | grep -qw "qlen 5" || { echo "queue length:"; ip link show can0; exit 1; }
        networkctl status can0 | grep -q "Network File: .*/80-can.network" || { networkctl status can0; exit 2; }
        journalctl --boot | grep -E "80-can\.(network|link):" && exit 3
        exit 0' || refute "status $?"
}

# In a guest, with a vcan in the bus's place. The watchdog's limit is widened there: a guest on a busy machine may stand
# still for longer than the product ever may.
ControllerRunsUnderItsUnitWithRealTimePriorityAndNoPrivilege() {
    install_into_stage
    mkdir -p "$scratch/steadyboom-controller.service.d"
    printf '%s\n' '[Service]' 'WatchdogSec=2' >"$scratch/steadyboom-controller.service.d/guest.conf"
    "$repository/tests/vcan/vcan-run" -t 110 -s -i can0 -U "$scratch/steadyboom-controller.service.d" bash -c '
        unit=steadyboom-controller.service
        refute() { echo "FAILED: $*"; systemctl status --no-pager --full --lines=30 $unit steadyboom-command.socket; exit 1; }
        cp -r "$1"/. / && systemd-sysusers && systemctl daemon-reload || refute "installation"
        systemctl start steadyboom-can@can0.service $unit || refute "it does not start"
        main=$(systemctl show --value -p MainPID $unit)
        chrt -p "$main" | grep -q "policy: SCHED_FIFO" && chrt -p "$main" | grep -q "priority: 80" ||
            refute "scheduling: $(chrt -p "$main")"
        for task in /proc/"$main"/task/*; do
            [ "${task##*/}" = "$main" ] || chrt -p "${task##*/}" | grep -q "policy: SCHED_OTHER" || refute "a helper thread: $(chrt -p "${task##*/}")"
        done
        grep -q "^CapEff:.*\b0*$" /proc/"$main"/status || refute "$(grep CapEff /proc/"$main"/status)"
        grep -q "^Seccomp:.*2$" /proc/"$main"/status || refute "no system call filter"
        grep -q "^VmLck:.* 0 kB" /proc/"$main"/status && refute "no memory is locked"
        timeout 10 candump -n 20 can0 >/dev/null || refute "nothing on the bus"
        steadyboomctl status || refute "no answer on the socket from systemd"
        for try in {1..100}; do steadyboomctl status | grep -q "not watched" || break; sleep 0.1; done
        ! steadyboomctl status | grep "not watched" || refute "the link supervisor is not heard"
        supervisor=$(systemctl show --value -p MainPID steadyboom-can@can0.service)
        grep -q "^CapEff:.*0000001000$" /proc/"$supervisor"/status || refute "$(grep Cap /proc/"$supervisor"/status)"
        grep -q "^CapBnd:.*0000001000$" /proc/"$supervisor"/status || refute "$(grep Cap /proc/"$supervisor"/status)"
        sleep 5
        [ "$(systemctl is-active $unit)$(systemctl show --value -p NRestarts $unit)" = active0 ] ||
            refute "it does not outlive its watchdog"
        systemctl stop $unit && [ "$(systemctl show --value -p Result $unit)" = success ] || refute "it does not stop in order"
        ' bash "$stage" || refute "status $?"
}

# The beam is for the virtual crane; the observer models the links.
ControllerCarriesNoBeamBoom() {
    nm -C "$build/bin/steadyboom-plant" | grep -q 'plant::BeamBoom' || refute "no such symbol to look for"
    ! nm -C "$build/bin/steadyboom-controller" | grep 'plant::BeamBoom' || refute "the controller carries it"
}

declare -F -- "$claim" >/dev/null && [[ $claim =~ ^[A-Z] ]] || refute "no such claim: $claim"
[ -d "$build" ] || refute "no build directory: $build"
"$claim"
