"""Made traces for the packs: one that satisfies all requirements, and for each one what violates it.

A signal is a number, or a function of the time in seconds; recorded names are those of the newest versions.
"""

from __future__ import annotations

from math import cos, inf, radians, sin

import numpy as np

#: Seconds, and samples in a second.
LENGTH, RATE = 15, 10


def made(signals, **changed):
    """Return a recording: from each name to times and values."""
    times = np.arange(LENGTH * RATE + 1) / RATE
    return {
        name: (times, np.array([float(value(t) if callable(value) else value) for t in times]))
        for name, value in {**signals, **changed}.items()
    }


def after(begin, value, before=0.0, end=inf):
    """Return a signal that has a value from ``begin`` on, until ``end``."""
    return lambda t: value if begin <= t < end else before


_TOPICS = (
    "battery_status",
    "vehicle_attitude",
    "vehicle_angular_velocity",
    "vehicle_rates_setpoint",
    "vehicle_imu_status",
    "estimator_status",
    "vehicle_gps_position",
)


def _stopped(topic):
    return {f"{topic}.timestamp": lambda t: 1e6 * min(t, 5)}


_ROLLED = {"vehicle_attitude.q[0]": cos(radians(10)), "vehicle_attitude.q[1]": sin(radians(10))}
_PITCHED = {"vehicle_attitude.q[0]": cos(radians(10)), "vehicle_attitude.q[2]": sin(radians(10))}
_FALLEN = {"vehicle_attitude.q[0]": cos(radians(35)), "vehicle_attitude.q[1]": sin(radians(35))}

PX4 = {
    "vehicle_status.arming_state": 2,
    "vehicle_status.failsafe": 0,
    "failsafe_flags.manual_control_signal_lost": 0,
    "battery_status.voltage_v": 15.2,
    "battery_status.cell_count": 4,
    "battery_status.remaining": lambda t: 0.9 - t / 100,
    **{f"{topic}.timestamp": lambda t: 1e6 * t for topic in _TOPICS},
    "vehicle_attitude.q[0]": 1,
    "vehicle_attitude.q[1]": 0,
    "vehicle_attitude.q[2]": 0,
    "vehicle_attitude.q[3]": 0,
    "vehicle_attitude_setpoint.q_d[0]": cos(radians(4)),
    "vehicle_attitude_setpoint.q_d[1]": sin(radians(4)),
    "vehicle_attitude_setpoint.q_d[2]": 0,
    "vehicle_attitude_setpoint.q_d[3]": 0,
    "vehicle_attitude_setpoint.roll_body": radians(4),
    "vehicle_attitude_setpoint.pitch_body": 0,
    "vehicle_attitude_setpoint.thrust": 0.5,
    "vehicle_attitude_setpoint.thrust_body[2]": -0.5,
    "vehicle_angular_velocity.xyz[0]": sin,
    "vehicle_angular_velocity.xyz[1]": 0,
    "vehicle_angular_velocity.xyz[2]": 0,
    "vehicle_rates_setpoint.roll": lambda t: sin(t + 0.1),
    "vehicle_rates_setpoint.pitch": 0,
    "vehicle_rates_setpoint.yaw": 0,
    "vehicle_imu_status.accel_vibration_metric": 2,
    "estimator_status.vibe[2]": 0.01,
    "estimator_status.vel_test_ratio": 0.1,
    "estimator_status.pos_test_ratio": 0.1,
    "estimator_status.hgt_test_ratio": 0.1,
    "estimator_status.hdg_test_ratio": after(5, 1.5, 0.1, 5.5),
    "estimator_status.filter_fault_flags": 0,
    "vehicle_gps_position.fix_type": 3,
    "vehicle_gps_position.satellites_used": 12,
    "vehicle_gps_position.eph": 0.8,
}

#: From each requirement to the signals that violate it.
PX4_VIOLATED = {
    "ARM-1": {"vehicle_status.arming_state": 1},
    "BAT-1": {"battery_status.voltage_v": after(5, 13.9, 15.2, 8)},
    "BAT-2": {"battery_status.remaining": 0.06},
    "BAT-3": {"battery_status.remaining": 0.1},
    "BAT-4": {"battery_status.cell_count": 0},
    "BAT-5": {"battery_status.remaining": after(5, -1, 0.8)},
    "BAT-6": _stopped("battery_status"),
    "ATT-1": _ROLLED | {"vehicle_attitude_setpoint.q_d[1]": -sin(radians(4))},
    "ATT-2": _PITCHED,
    "ATT-3": _ROLLED | {"vehicle_attitude_setpoint.roll_body": radians(-4)},
    "ATT-4": _PITCHED | {"vehicle_attitude_setpoint.pitch_body": radians(-4)},
    "ATT-5": _FALLEN,
    "ATT-6": _stopped("vehicle_attitude"),
    "RATE-1": {"vehicle_rates_setpoint.roll": after(5, 2)},
    "RATE-2": {"vehicle_rates_setpoint.pitch": after(5, 2)},
    "RATE-3": {"vehicle_rates_setpoint.yaw": after(5, -2)},
    "RATE-4": _stopped("vehicle_angular_velocity"),
    "RATE-5": _stopped("vehicle_rates_setpoint"),
    "VIB-1": {"vehicle_imu_status.accel_vibration_metric": after(5, 6, 2, 8)},
    "VIB-2": {"estimator_status.vibe[2]": after(5, 0.05, 0.01, 8)},
    "VIB-3": _stopped("vehicle_imu_status"),
    "EKF-1": {"estimator_status.vel_test_ratio": after(5, 1.2, 0, 7)},
    "EKF-2": {"estimator_status.pos_test_ratio": after(5, 1.2, 0, 7)},
    "EKF-3": {"estimator_status.hgt_test_ratio": after(5, 1.2, 0, 7)},
    "EKF-4": {"estimator_status.hdg_test_ratio": after(5, 1.2, 0, 7)},
    "EKF-5": {"estimator_status.vel_test_ratio": after(5, 0.6)},
    "EKF-6": {"estimator_status.pos_test_ratio": after(5, 0.6)},
    "EKF-7": {"estimator_status.hgt_test_ratio": after(5, 0.6)},
    "EKF-8": {"estimator_status.hdg_test_ratio": after(5, 0.6)},
    "EKF-9": {"estimator_status.filter_fault_flags": after(14, 4)},
    "EKF-10": _stopped("estimator_status"),
    "GPS-1": {"vehicle_gps_position.fix_type": after(5, 2, 3, 7)},
    "GPS-2": {"vehicle_gps_position.satellites_used": after(5, 5, 9, 7)},
    "GPS-3": {"vehicle_gps_position.eph": after(5, 3.5, 1, 7)},
    "GPS-4": _stopped("vehicle_gps_position"),
    "RC-1": {"failsafe_flags.manual_control_signal_lost": after(5, 1)},
}

DRIVING = {
    "ego_speed": 20,
    "ego_acceleration": 0,
    "speed_limit": 22,
    "lead_gap": 80,
    "lead_speed": 20,
    "side_gap": 2,
    "ego_lateral_speed": 0,
    "side_lateral_speed": -0.1,
}

_TOO_NEAR = {"lead_gap": after(5, 30, 80)}

DRIVING_VIOLATED = {
    "RSS-1": _TOO_NEAR,
    "RSS-2": {"side_lateral_speed": after(5, -1)},
    "RSS-3": _TOO_NEAR,
    "R_G1": {"lead_gap": lambda t: 80 - 6 * t},
    "R_G2": {"ego_acceleration": after(5, -2.5)},
    "R_G4": {"ego_speed": after(5, 11, 20)},
    "LIMIT-1": {"ego_speed": after(5, 23, 20)},
    "GAP-1": {"lead_gap": after(5, 15, 80)},
    "TTC-1": {"lead_gap": after(5, 14, 80), "lead_speed": 10},
    "COMF-1": {"ego_acceleration": after(5, 2.5, 0, 9)},
    "COMF-2": {"ego_acceleration": after(5, -4, 0, 9)},
    "COMF-3": {"ego_acceleration": after(5, -3, 0, 9)},
}

BASE = {
    "/cmd_vel.linear.x": after(2, 0.2, 0, 10),
    "/cmd_vel.angular.z": 0,
    "/odom.twist.twist.linear.x": lambda t: min(0.2, max(0, (t - 2) / 2)) if t < 10 else 0,
    "/odom.twist.twist.angular.z": 0.1,
    "/scan.ranges.min": 1,
    "/emergency_stop.data": after(12, 1),
    "/amcl_pose.pose.covariance[0]": 0.01,
    "/amcl_pose.pose.covariance[7]": 0.02,
    "/amcl_pose.pose.covariance[35]": 0.01,
    "/battery_state.percentage": 0.8,
}

BASE_VIOLATED = {
    "TRACK-1": {"/odom.twist.twist.linear.x": 0},
    "TRACK-2": {"/odom.twist.twist.angular.z": 0.4},
    "LIMIT-1": {"/cmd_vel.linear.x": after(5, 0.3)},
    "LIMIT-2": {"/cmd_vel.angular.z": after(5, -1.5)},
    "LIMIT-3": {"/odom.twist.twist.linear.x": after(5, 0.5)},
    "LIMIT-4": {"/odom.twist.twist.linear.x": after(5, 0.6)},
    "LIMIT-5": {"/odom.twist.twist.angular.z": after(5, 0.7)},
    "OBST-1": {"/scan.ranges.min": after(5, 0.2, 1)},
    "OBST-2": {"/scan.ranges.min": after(5, 0.3, 1)},
    "STOP-1": {"/emergency_stop.data": after(5, 1)},
    "LOC-1": {"/amcl_pose.pose.covariance[7]": after(5, 0.3)},
    "LOC-2": {"/amcl_pose.pose.covariance[35]": after(5, 0.1)},
    "BAT-1": {"/battery_state.percentage": 0.1},
}

#: From each pack to its satisfying signals and those that violate its requirements.
PACKS = {
    "px4": (PX4, PX4_VIOLATED),
    "driving": (DRIVING, DRIVING_VIOLATED),
    "mobile_base": (BASE, BASE_VIOLATED),
}
