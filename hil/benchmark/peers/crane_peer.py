"""The crane of the model with seven degrees of freedom, as one would write it with NumPy, driven over stdin and stdout.

Each line read is a JSON object and is answered by one. The first gives the crane's parameters; every other asks for an
integration: {"method": "rk4", "step_s": h, "steps": n, "start": [15 numbers]} or {"method": "RK45", "duration_s": T,
"relative": r, "absolute": a, "start": [...]}, answered by {"end": [...], "cpu_ns": n}. Ends with 77
when NumPy or SciPy is missing.
"""

import json
import math
import sys
import time

try:
    import numpy as np
    import scipy
    from scipy.integrate import solve_ivp
except ImportError:
    sys.exit(77)

# Row of the Jacobian, share of the chord, shares of q1 and q2 below it: the three links' centres and the boom tip.
LINKS_AND_LOAD = ((4, 1 / 6, 0.5, 0.0), (6, 0.5, 0.5, 0.5), (8, 5 / 6, 0.0, 0.5), (10, 1.0, 0.0, 0.0))


class Crane:
    """M p'' = Q with M = sum m J^T J + inertia; Q from the forces and from the accelerations that no p'' causes."""

    def __init__(self, parameters):
        self.__dict__.update(parameters)
        self.link_length = self.boom_length_m / 3.0
        m_B = self.boom_link_mass_kg
        masses = [self.track_mass_kg, self.car_body_mass_kg, m_B, m_B, m_B, self.load_mass_kg]
        self.masses = np.repeat(masses, 2)
        self.gravity = np.tile([0.0, 9.81], 6)
        self.inertia = np.zeros((7, 7))
        self.inertia[1, 1] = self.track_inertia_kg_m2 + self.car_body_inertia_kg_m2
        bending = self.boom_joint_stiffness_N_m * self.link_length / 3.0
        damping = (
            self.boom_damping_ratio * math.pi**2 * 3.0 / 8.0 * self.boom_length_m**2
            * math.sqrt(bending * m_B / (3.0 * self.boom_length_m**3))
        )
        self.joint_stiffness = 3.0 * self.boom_joint_stiffness_N_m / self.link_length**2
        self.joint_damping = damping / self.link_length**2
        self.free_pendent_m = self.pendent(self.boom_length_m, self.boom_angle_rad)[0]
        self.compliance = self.oil_volume_m3 * self.pendent_stiffness_N_m / (
            4.0 * self.piston_area_m2 * self.bulk_modulus_Pa
        )
        self.jacobian = np.zeros((12, 7))
        self.jacobian[1::2, 0] = 1.0
        self.bias = np.zeros(12)

    def pendent(self, R8, angle):
        """L_p and its slopes to R8 and to phi_B; `angle` is phi6 - phi2."""
        R_d = self.pendent_anchor_radius_m
        phi_B = self.pendent_anchor_angle_rad + math.pi / 2.0 - angle
        cosine = math.cos(phi_B)
        length = math.sqrt(R8 * R8 + R_d * R_d - 2.0 * R8 * R_d * cosine)
        return length, (R8 - R_d * cosine) / length, R8 * R_d * math.sin(phi_B) / length

    def soil(self, R1, phi2, v_R1, w2):
        """Forces on R1 and on phi2."""
        d_t, w_t, G, nu = self.track_half_length_m, self.track_width_m, self.shear_modulus_Pa, self.poisson_ratio
        if abs(phi2) < 1e-12:
            beta = 1.0 if R1 < 0.0 else 0.0
        else:
            f = min(d_t, max(-d_t, -R1 / abs(math.sin(phi2))))
            beta = 0.5 * (1.0 + f / d_t)
        e = -math.copysign(d_t * (1.0 - beta), phi2)
        R_v = math.sqrt(4.0 / math.pi * beta * d_t * w_t)
        R_r = (16.0 / (3.0 * math.pi) * (beta * d_t) ** 3 * w_t) ** 0.25
        impedance = math.sqrt(self.density_kg_m3 * G)
        K_V, C_V = 4.0 * G * R_v / (1.0 - nu), 3.4 * R_v**2 * impedance / (1.0 - nu)
        K_R, C_R = 2.52 * G * R_r**3 / (1.0 - nu), 0.136 * R_r**4 * impedance / (1.13 - nu)
        F = max(0.0, -K_V * (R1 + e * phi2) - C_V * (v_R1 + e * w2))
        return F, F * e - K_R * phi2 - C_R * w2

    def rate(self, _t, state):
        R1, phi2, R9, q1, q2, phi6, phi9, v_R1, w2, v_R9, v1, v2, w6, w9, piston = state.tolist()
        s2, c2, s6, c6, s9, c9 = (f(a) for a in (phi2, phi6, phi9) for f in (math.sin, math.cos))
        L_B = self.link_length
        R8 = self.boom_length_m - (q1 * q1 + q2 * q2 - q1 * q2) / L_B
        R8_1, R8_2 = (q2 - 2.0 * q1) / L_B, (q1 - 2.0 * q2) / L_B
        R8_rate = R8_1 * v1 + R8_2 * v2
        R8_bias = -2.0 * (v1 * v1 + v2 * v2 - v1 * v2) / L_B

        J, bias = self.jacobian, self.bias
        R2, R3, R4, R5 = (
            self.track_centre_height_m, self.car_body_height_m, self.car_body_setback_m, self.boom_butt_offset_m
        )
        s23, c23 = math.sin(phi2 - self.car_body_angle_rad), math.cos(phi2 - self.car_body_angle_rad)
        track_x, track_y = -R2 * c2, -R2 * s2
        car_x, car_y = -R3 * c2 + R4 * s23, -R3 * s2 - R4 * c23
        butt_x, butt_y = -R3 * c2 - R5 * s2, -R3 * s2 + R5 * c2
        J[:, 1] = (track_x, track_y, car_x, car_y) + (butt_x, butt_y) * 4
        square = w2 * w2
        bias[0:4] = (-square * track_y, square * track_x, -square * car_y, square * car_x)
        butt_bias_x, butt_bias_y = -square * butt_y, square * butt_x
        for body, along, d1, d2 in LINKS_AND_LOAD:
            a, b = along * R8, d1 * q1 + d2 * q2
            b_rate = d1 * v1 + d2 * v2
            J[body, 3:6] = (
                along * R8_1 * c6 + d1 * s6, along * R8_2 * c6 + d2 * s6, -a * s6 + b * c6
            )
            J[body + 1, 3:6] = (
                along * R8_1 * s6 - d1 * c6, along * R8_2 * s6 - d2 * c6, a * c6 + b * s6
            )
            forth = along * R8_bias - a * w6 * w6 + 2.0 * b_rate * w6
            below = -2.0 * along * R8_rate * w6 - b * w6 * w6
            bias[body] = butt_bias_x + forth * c6 + below * s6
            bias[body + 1] = butt_bias_y + forth * s6 - below * c6
        J[10, 2], J[11, 2], J[10, 6], J[11, 6] = s9, -c9, R9 * c9, R9 * s9
        swing, pull = 2.0 * v_R9 * w9, -R9 * w9 * w9
        bias[10] += swing * c9 + pull * s9
        bias[11] += swing * s9 - pull * c9

        length, slope_R8, slope_B = self.pendent(R8, phi6 - phi2)
        held = min(self.piston_travel_m, max(-self.piston_travel_m, piston))
        tension = max(0.0, self.pendent_stiffness_N_m * (length - self.free_pendent_m + held))
        line = max(0.0, self.load_line_stiffness_N_m * (R9 - self.load_line_length_m))
        F_V, F_R = self.soil(R1, phi2, v_R1, w2)
        K, C, R8_pull = self.joint_stiffness, self.joint_damping, tension * slope_R8
        force = np.array((
            F_V,
            F_R - tension * slope_B,
            -line,
            -K * (2.0 * q1 - q2) - C * (5.0 * v1 - 4.0 * v2) - R8_1 * R8_pull,
            -K * (2.0 * q2 - q1) - C * (5.0 * v2 - 4.0 * v1) - R8_2 * R8_pull,
            tension * slope_B,
            0.0,
        ))
        weighted = J.T * self.masses
        result = np.empty(15)
        result[0:7] = state[7:14]
        result[7:14] = np.linalg.solve(weighted @ J + self.inertia, force - weighted @ (bias + self.gravity))
        c = self.compliance if tension > 0.0 else 0.0
        length_rate = slope_R8 * R8_rate + slope_B * (w2 - w6)
        pressure = tension / self.piston_area_m2
        piston_rate = (-self.leakage_m3_s_Pa * pressure - c * length_rate) / (self.piston_area_m2 + c)
        at_stop = abs(piston) >= self.piston_travel_m and piston * piston_rate > 0.0
        result[14] = 0.0 if at_stop else piston_rate
        return result


def rk4(rate, state, step, steps):
    for n in range(steps):
        t = n * step
        k1 = rate(t, state)
        k2 = rate(t + 0.5 * step, state + 0.5 * step * k1)
        k3 = rate(t + 0.5 * step, state + 0.5 * step * k2)
        k4 = rate(t + step, state + step * k3)
        state = state + step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return state


def answer(crane, request):
    start = np.array(request["start"])
    begin_ns = time.thread_time_ns()
    if request["method"] == "rk4":
        end = rk4(crane.rate, start, request["step_s"], request["steps"])
    else:
        end = solve_ivp(
            crane.rate, (0.0, request["duration_s"]), start, method=request["method"],
            t_eval=(request["duration_s"],), rtol=request["relative"], atol=request["absolute"],
        ).y[:, -1]
    cpu_ns = time.thread_time_ns() - begin_ns
    return {"end": end.tolist(), "cpu_ns": cpu_ns}


def main():
    crane = Crane(json.loads(sys.stdin.readline()))
    print(json.dumps({"versions": f"NumPy {np.__version__}, SciPy {scipy.__version__}"}), flush=True)
    for line in sys.stdin:
        print(json.dumps(answer(crane, json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
