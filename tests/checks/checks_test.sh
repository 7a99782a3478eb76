#!/bin/bash
# Claims about scripts/check-includes and scripts/check-words: that they pass on a good tree and notice a bad one.
# Usage: checks_test.sh CLAIM
set -u
scripts=$(realpath -- "$(dirname -- "$0")/../../scripts")
tree=$(mktemp -d) || exit 1
trap 'rm -rf "$tree"' EXIT

refute() {
    echo "FAILED: $*"
    exit 1
}
write() { # file, then its lines
    mkdir -p "$tree/$(dirname "$1")"
    printf '%s\n' "${@:2}" >"$tree/$1"
}
good_tree() {
    write plant/crane.hpp '#include <vector>'
    write drivers/bus.hpp '#include "plant/crane.hpp"'
    write controllers/law.hpp '#include "plant/crane.hpp"'
    write runtime/loop.hpp '#include <thread>'
    write runtime/loop.cpp '#include "runtime/loop.hpp"'
    write runtime/tick.hpp '#include "drivers/bus.hpp"' '#include "controllers/law.hpp"'
    write runtime/telemetry/publisher.cpp '#include <lcm/lcm-cpp.hpp>' '#include "runtime/tick.hpp"'
    write runtime/CMakeLists.txt 'add_library(steadyboom_realtime STATIC' '  loop.cpp)'
    write hil/bench.hpp '#include "runtime/tick.hpp"'
    write tests/bench_test.cpp '#include "hil/bench.hpp"'
}
refuse_include() { # file, include line
    good_tree
    write "$1" "$2"
    "$scripts/check-includes" "$tree" >"$tree/log" && refute "check-includes passed $2 in $1"
    grep -q "^$1:" "$tree/log" || refute "$1 is not named: $(<"$tree/log")"
}
refuse_words() { # a line
    write docs/page.md "$1"
    ! "$scripts/check-words" "$tree" >/dev/null || refute "check-words passed: $1"
}

GoodTreePasses() {
    good_tree
    "$scripts/check-includes" "$tree" || refute "check-includes"
    write docs/page.md 'See /usr/bin and build/release/hil; the work goes on, 40 issues a year.'
    "$scripts/check-words" "$tree" || refute "check-words"
}
EveryForbiddenArrowIsNoticed() {
    refuse_include plant/mass.hpp '#include "drivers/bus.hpp"'
    refuse_include drivers/codec.cpp '#include "controllers/law.hpp"'
    refuse_include controllers/observer.cpp '#include "drivers/bus.hpp"'
    refuse_include controllers/limiter.cpp '#  include <runtime/tick.hpp>'
    refuse_include runtime/main.cpp '#include "hil/bench.hpp"'
    refuse_include hil/report.cpp '#include "tests/bench_test.hpp"'
}
LcmOutsideTheTelemetryIsNoticed() {
    refuse_include runtime/tick.hpp '#include <lcm/lcm-cpp.hpp>'
    refuse_include hil/report.hpp '#include "lcm/lcm.h"'
}
IncludeNotNamedFromTheRootIsNoticed() {
    refuse_include plant/mass.cpp '#include "crane.hpp"'
    refuse_include plant/mass.cpp '#include "plant/absent.hpp"'
}
CraneBelowTheLoopIsNoticedThroughAnotherHeader() {
    good_tree
    write runtime/clock.hpp '#include "plant/crane.hpp"'
    write runtime/loop.hpp '#include "runtime/clock.hpp"'
    ! "$scripts/check-includes" "$tree" >"$tree/log" || refute "check-includes passed"
    grep -q '^runtime/clock.hpp: steadyboom_realtime knows nothing of cranes' "$tree/log" || refute "$(<"$tree/log")"
}
WordsThatAreNotOfTheProductAreNoticed() {
    refuse_words "run it in $(printf '/%s/me/steadyboom' home)"
    refuse_words "$(printf 'TO%s: the rest' DO)"
    refuse_words "$(printf 'GTEST%s();' _SKIP)"
    refuse_words "$(printf 'see %s 12' issue)"
}

declare -F -- "${1:-}" >/dev/null && [[ $1 =~ ^[A-Z] ]] || refute "no such claim: ${1:-}"
"$1"
