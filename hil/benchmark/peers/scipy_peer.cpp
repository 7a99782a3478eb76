#include "hil/benchmark/peers/scipy_peer.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

namespace steadyboom::hil::benchmark {

namespace {

constexpr const char* python = "/usr/bin/python3";
constexpr int exit_code_without_packages = 77;

nlohmann::json to_json(const plant::CraneParameters& crane) {
    const plant::StructureParameters& s = crane.structure;
    const plant::SoilParameters& soil = crane.soil;
    const plant::RopeParameters& ropes = crane.ropes;
    const plant::ActuatorParameters& actuator = crane.actuator;
    return {{"boom_length_m", s.boom_length_m},
            {"boom_link_mass_kg", s.boom_link_mass_kg},
            {"boom_joint_stiffness_N_m", s.boom_joint_stiffness_N_m},
            {"boom_damping_ratio", s.boom_damping_ratio},
            {"boom_angle_rad", s.boom_angle_rad},
            {"load_mass_kg", s.load_mass_kg},
            {"track_mass_kg", s.track_mass_kg},
            {"car_body_mass_kg", s.car_body_mass_kg},
            {"track_inertia_kg_m2", s.track_inertia_kg_m2},
            {"car_body_inertia_kg_m2", s.car_body_inertia_kg_m2},
            {"track_centre_height_m", s.track_centre_height_m},
            {"car_body_height_m", s.car_body_height_m},
            {"car_body_setback_m", s.car_body_setback_m},
            {"boom_butt_offset_m", s.boom_butt_offset_m},
            {"car_body_angle_rad", s.car_body_angle_rad},
            {"pendent_anchor_radius_m", s.pendent_anchor_radius_m},
            {"pendent_anchor_angle_rad", s.pendent_anchor_angle_rad},
            {"shear_modulus_Pa", soil.shear_modulus_Pa},
            {"poisson_ratio", soil.poisson_ratio},
            {"density_kg_m3", soil.density_kg_m3},
            {"track_half_length_m", soil.track_half_length_m},
            {"track_width_m", soil.track_width_m},
            {"load_line_length_m", ropes.load_line_length_m},
            {"load_line_stiffness_N_m", ropes.load_line_stiffness_N_m},
            {"pendent_stiffness_N_m", ropes.pendent_stiffness_N_m},
            {"piston_area_m2", actuator.piston_area_m2},
            {"oil_volume_m3", actuator.oil_volume_m3},
            {"bulk_modulus_Pa", actuator.bulk_modulus_Pa},
            {"leakage_m3_s_Pa", actuator.leakage_m3_s_Pa},
            {"piston_travel_m", actuator.piston_travel_m}};
}

struct Pipe {
    int read_end;
    int write_end;
};
Pipe open_pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        throw std::runtime_error(std::string("pipe2: ") + std::strerror(errno));
    }
    return {ends[0], ends[1]};
}

}  // namespace

std::unique_ptr<ScipyPeer> ScipyPeer::start(const plant::CraneParameters& crane) {
    const Pipe requests = open_pipe();
    const Pipe answers = open_pipe();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, requests.read_end, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, answers.write_end, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    char* const arguments[] = {const_cast<char*>(python), const_cast<char*>(STEADYBOOM_CRANE_PEER), nullptr};
    pid_t pid = -1;
    const int failure = posix_spawn(&pid, python, &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(requests.read_end);
    close(answers.write_end);
    // A child that is gone is seen by its silence, not by a signal.
    std::signal(SIGPIPE, SIG_IGN);
    std::unique_ptr<ScipyPeer> peer(new ScipyPeer(failure == 0 ? pid : -1, requests.write_end, answers.read_end));
    const std::optional<nlohmann::json> hello = peer->exchange(to_json(crane));
    if (!hello) {
        if (failure == ENOENT || peer->end() == exit_code_without_packages) {
            return nullptr;
        }
        throw std::runtime_error("the SciPy peer did not start; run hil/benchmark/peers/crane_peer.py by hand");
    }
    peer->versions_ = hello->at("versions");
    return peer;
}

ScipyPeer::ScipyPeer(int pid, int to_child, int from_child) : pid_(pid), to_child_(to_child), from_child_(from_child) {}

ScipyPeer::~ScipyPeer() {
    static_cast<void>(end());
    close(from_child_);
}

int ScipyPeer::end() noexcept {
    if (to_child_ >= 0) {
        close(to_child_);
        to_child_ = -1;
    }
    int status = 0;
    if (pid_ > 0) {
        waitpid(pid_, &status, 0);
        pid_ = -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::optional<nlohmann::json> ScipyPeer::exchange(const nlohmann::json& request) {
    const std::string line = request.dump() + "\n";
    if (write(to_child_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
        return std::nullopt;
    }
    std::size_t end = 0;
    while ((end = unread_.find('\n')) == std::string::npos) {
        char part[4096];
        const ssize_t got = read(from_child_, part, sizeof(part));
        if (got <= 0) {
            return std::nullopt;
        }
        unread_.append(part, static_cast<std::size_t>(got));
    }
    const nlohmann::json answer = nlohmann::json::parse(unread_.substr(0, end));
    unread_.erase(0, end + 1);
    return answer;
}

ScipyPeer::Run ScipyPeer::run(nlohmann::json request, const plant::CraneState& start) {
    request["start"] = std::vector<double>(start.begin(), start.end());
    const std::optional<nlohmann::json> answer = exchange(request);
    if (!answer) {
        throw std::runtime_error("the SciPy peer ended unasked; run hil/benchmark/peers/crane_peer.py by hand");
    }
    Run result{plant::CraneState::Zero(), answer->at("cpu_ns")};
    for (int i = 0; i < plant::state_count; ++i) {
        result.end[i] = answer->at("end").at(static_cast<std::size_t>(i));
    }
    return result;
}

ScipyPeer::Run ScipyPeer::rk4(const plant::CraneState& start, double step_s, int steps) {
    return run({{"method", "rk4"}, {"step_s", step_s}, {"steps", steps}}, start);
}

ScipyPeer::Run ScipyPeer::rk45(const plant::CraneState& start, double duration_s, double relative, double absolute) {
    return run({{"method", "RK45"}, {"duration_s", duration_s}, {"relative", relative}, {"absolute", absolute}}, start);
}

}  // namespace steadyboom::hil::benchmark
