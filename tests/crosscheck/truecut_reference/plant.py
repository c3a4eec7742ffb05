"""The arm in MuJoCo: RK4, springs in the joints, forces at the sites `tool` and `foot`.

Forces are held constant over a step, so the caller evaluates them at mid-step; then the whole scheme is of second
order (a force taken at the step's start would make it first order). After an RK4 step MuJoCo's derived quantities
belong to the last stage, whose state differs from the new one by O(h^3): they are used as the new ones.
"""

from __future__ import annotations

import mujoco
import numpy as np

from .scenario import Robot

GRAVITY_M_PER_S2 = 9.81


def process_axes(tool_rotation: np.ndarray) -> np.ndarray:
    """Rows X, Y, Z of the process frame in the world: X along the tool's z axis, Y horizontal, Z = X x Y."""
    x = tool_rotation[:, 2]
    y = np.cross([0.0, 0.0, 1.0], x)
    if np.linalg.norm(y) < 1e-6:
        y = np.cross(x, [1.0, 0.0, 0.0])
    y = y / np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


class Plant:
    """One arm at its start posture. Vectors of the process frame are rows (X, Y, Z); see `process_axes`."""

    def __init__(self, model: str | mujoco.MjModel, robot: Robot, q0: np.ndarray | None = None) -> None:
        """`model` is MJCF text or a compiled model with the sites flange, tool and foot; `q0` stands for the robot's posture."""
        if robot.drive not in ("position", "force"):
            raise NotImplementedError(f"drive '{robot.drive}' has no counterpart in the reference")
        self.model = mujoco.MjModel.from_xml_string(model) if isinstance(model, str) else model
        self.data = mujoco.MjData(self.model)
        m = self.model
        m.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        m.opt.gravity[:] = (0.0, 0.0, -GRAVITY_M_PER_S2 if robot.gravity else 0.0)
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.nv = m.nv
        if np.any(m.dof_frictionloss):
            raise NotImplementedError("dry friction in the joints has no counterpart in the reference")
        self.site = {n: mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_SITE, n) for n in ("flange", "tool", "foot")}
        missing = [n for n, i in self.site.items() if i < 0]
        if missing:
            raise ValueError(f"the model has no site {missing}")
        self.body = {n: int(m.site_bodyid[i]) for n, i in self.site.items()}
        self.stiffness = m.jnt_stiffness.reshape(self.nv, -1)[:, 0].copy()
        self.damping = m.dof_damping.reshape(self.nv, -1)[:, 0].copy()
        self.q0 = posture(m, robot) if q0 is None else np.array(q0, dtype=float)
        self.data.qpos[:] = self.q0
        mujoco.mj_forward(m, self.data)
        tool = self.data.site("tool")
        self.tool_rotation0 = tool.xmat.reshape(3, 3).copy()
        self.tool_position0 = tool.xpos.copy()
        self.axes = process_axes(self.tool_rotation0)
        self.free = robot.drive == "force"
        if self.free and np.any(self.stiffness):
            raise ValueError("drive 'force' leaves the joints free, but the model has joint springs")
        self._makes_up_for_sag = robot.hold_against_sag and not self.free
        self.command0 = self.command_for(self.q0) if self._makes_up_for_sag else self.q0.copy()
        m.qpos_spring[:] = self.command0
        self._jac_tool = np.zeros((3, self.nv))
        self._jac_foot = np.zeros((3, self.nv))
        self._torque = np.zeros(3)
        self._rotation = np.kron(np.eye(2), self.axes)

    # -- statics -----------------------------------------------------------------------------------------------

    def command_for(self, q: np.ndarray) -> np.ndarray:
        """Spring rest angles that hold the arm at rest at `q` under gravity."""
        scratch = mujoco.MjData(self.model)
        scratch.qpos[:] = q
        mujoco.mj_forward(self.model, scratch)
        return q + scratch.qfrc_bias / self.stiffness

    def rigid_posture(self, command: np.ndarray) -> np.ndarray:
        """Posture that a command asks for: less what it makes up for the sag, if it does."""
        q = command.copy()
        if not self._makes_up_for_sag:
            return q
        for _ in range(50):
            change = command - self.command_for(q)
            q += change
            if np.max(np.abs(change)) < 1e-14:
                return q
        raise RuntimeError("no posture sags into the command")

    def settle(self, force_tool: np.ndarray, force_foot: np.ndarray, moment_tool=None) -> None:
        """Puts the arm at rest in static equilibrium under the given loads (N, N m, process frame); a free arm at q0."""
        d, m = self.data, self.model
        d.qvel[:] = 0.0
        if self.free:
            self.apply(force_tool, force_foot)
            mujoco.mj_forward(m, d)
            return
        for _ in range(200):
            self.apply(force_tool, force_foot, None, moment_tool)
            mujoco.mj_forward(m, d)
            self.apply(force_tool, force_foot, None, moment_tool)  # moment arms of the new posture
            residual = d.qfrc_passive + d.qfrc_applied - d.qfrc_bias
            change = residual / self.stiffness
            d.qpos[:] += change
            if np.max(np.abs(change)) < 1e-14:
                break
        else:
            raise RuntimeError("static equilibrium not found")
        mujoco.mj_forward(m, d)
        self.apply(force_tool, force_foot, None, moment_tool)
        mujoco.mj_forward(m, d)

    def start_moving(self, qvel: np.ndarray) -> None:
        """Gives the arm, where it stands, its first joint velocities."""
        self.data.qvel[:] = qvel
        mujoco.mj_forward(self.model, self.data)

    def deflection(self, site: str, force: np.ndarray, moment: np.ndarray) -> np.ndarray:
        """Displacement of a site under a force and a moment (world axes, N, N m), linear, gravity left out; m, world axes."""
        scratch = mujoco.MjData(self.model)
        scratch.qpos[:] = self.q0
        mujoco.mj_forward(self.model, scratch)
        along, about = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        mujoco.mj_jacSite(self.model, scratch, along, about, self.site[site])
        return along @ ((along.T @ force + about.T @ moment) / self.stiffness)

    def fastest_mode_hz(self) -> float:
        """Highest natural frequency at the start posture."""
        return float(modes_hz(self.stiffness, self.mass_matrix())[-1])

    def compliance(self, site: str) -> np.ndarray:
        """Translational compliance J K^-1 J^T (m/N) at the start posture, process axes, gravity left out."""
        scratch = mujoco.MjData(self.model)
        scratch.qpos[:] = self.q0
        mujoco.mj_forward(self.model, scratch)
        jac = np.zeros((3, self.nv))
        mujoco.mj_jacSite(self.model, scratch, jac, None, self.site[site])
        jac = self.axes @ jac
        return jac @ np.diag(1.0 / self.stiffness) @ jac.T

    # -- motion ------------------------------------------------------------------------------------------------

    def apply(self, force_tool, force_foot, torque_joints=None, moment_tool=None) -> None:
        """Sets the forces (N, process frame) at the two sites, a moment at the tool and joint torques, for the steps to come."""
        m, d = self.model, self.data
        applied = d.qfrc_applied
        if torque_joints is None:
            applied[:] = 0.0
        else:
            applied[:] = torque_joints
        if moment_tool is not None:
            moment, point = np.dot(moment_tool, self.axes), d.site_xpos[self.site["tool"]]
            mujoco.mj_applyFT(m, d, self._torque, moment, point, self.body["tool"], applied)
        for name, force in (("tool", force_tool), ("foot", force_foot)):
            if force[0] or force[1] or force[2]:
                mujoco.mj_applyFT(
                    m, d, np.dot(force, self.axes), self._torque, d.site_xpos[self.site[name]], self.body[name], applied
                )

    def kinematics(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions (6) and [velocity, acceleration] (6 x 2) of tool and foot, process frame, at the present state."""
        m, d = self.model, self.data
        mujoco.mj_jacSite(m, d, self._jac_tool, None, self.site["tool"])
        mujoco.mj_jacSite(m, d, self._jac_foot, None, self.site["foot"])
        self.jacobian = self._rotation @ np.concatenate((self._jac_tool, self._jac_foot))
        position = np.concatenate(
            (self.axes @ d.site_xpos[self.site["tool"]], self.axes @ d.site_xpos[self.site["foot"]])
        )
        return position, self.jacobian @ np.array((d.qvel, d.qacc)).T

    def mobility(self) -> np.ndarray:
        """Inverse effective mass (6 x 6, 1/kg) of tool and foot at the present state; call after `kinematics`."""
        return self.jacobian @ np.linalg.solve(self.mass_matrix(), self.jacobian.T)

    def mass_matrix(self) -> np.ndarray:
        """Joint-space inertia at the state of the last evaluation."""
        full = np.zeros((self.nv, self.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full

    def step(self, h: float) -> None:
        """Advances by h seconds with the forces last applied."""
        self.model.opt.timestep = h
        mujoco.mj_step(self.model, self.data)


def posture(model: mujoco.MjModel, robot: Robot) -> np.ndarray:
    """Joint coordinates of the scenario's start posture, in chain order; joints that are not listed stand at zero."""
    rotary, linear = list(robot.posture_rad), list(robot.posture_m)
    q = np.zeros(model.nq)
    for n in range(model.njnt):
        source = linear if model.jnt_type[n] == mujoco.mjtJoint.mjJNT_SLIDE else rotary
        q[n] = source.pop(0) if source else 0.0
    return q


def modes_hz(stiffness: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Natural frequencies of M q'' + K q = 0 in Hz, ascending; `stiffness` is the diagonal of K."""
    import scipy.linalg

    squares = scipy.linalg.eigh(np.diag(stiffness), mass, eigvals_only=True)
    return np.sqrt(squares) / (2.0 * np.pi)
