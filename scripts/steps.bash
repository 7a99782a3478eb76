# Sourced by the scripts that run many steps: each step's name, outcome and time, all steps run, one line at the end.

steps_passed=() steps_failed=() steps_started_s=$SECONDS

minutes() { printf '%d min %02d s' $(($1 / 60)) $(($1 % 60)); }

# step NAME COMMAND...: a failure is noted and the next step runs; status as the command's.
step() {
    local name=$1 started_s=$SECONDS status=0
    shift
    printf '\n== %s: %s\n' "$name" "$*"
    "$@" </dev/null || status=$?
    if [ $status = 0 ]; then
        steps_passed+=("$name")
        printf '== %s: passed in %s\n' "$name" "$(minutes $((SECONDS - started_s)))"
    else
        steps_failed+=("$name")
        printf '== %s: FAILED with status %d after %s\n' "$name" $status "$(minutes $((SECONDS - started_s)))"
    fi
    return $status
}

# The closing line; ends the script.
finish() {
    local failures=''
    [ ${#steps_failed[@]} = 0 ] || failures=" ($(printf '%s, ' "${steps_failed[@]}" | sed 's/, $//'))"
    printf '\n%s: %d steps passed, %d failed%s, %s, commit %s\n' "${0##*/}" ${#steps_passed[@]} ${#steps_failed[@]} \
        "$failures" "$(minutes $((SECONDS - steps_started_s)))" \
        "$(git describe --always --dirty 2>/dev/null || echo unknown)"
    [ ${#steps_failed[@]} = 0 ] || exit 1
    exit 0
}

build_preset() { cmake --preset "$1" && cmake --build --preset "$1" --parallel "$(nproc)"; }

run_ctest() { # build directory, then ctest's choice of tests
    ctest --test-dir "$1" --output-on-failure --no-tests=error "${@:2}"
}
