"""Nine robots in MJCF, which together have every form that is read, and what MuJoCo computes for them."""

import warnings

import mujoco
import numpy as np

FORMS = """\
<mujoco model="forms">
  <compiler angle="degree"/>
  <option gravity="0.5 -0.3 -9.7"/>
  <worldbody>
    <body name="one" pos="0.1 0 0.3" euler="10 20 30">
      <inertial pos="0.1 0.02 0.03" mass="2" diaginertia="0.03 0.04 0.05" quat="1 0.2 0.3 -0.4"/>
      <joint name="turn" axis="0.2 0.3 1" range="-90 120" armature="0.2" damping="3" frictionloss="0.4"
             actuatorfrcrange="-30 40"/>
      <body name="two" pos="0.2 0 0.1" axisangle="1 2 3 40">
        <inertial pos="0 0.1 0.1" mass="1.5" fullinertia="0.02 0.03 0.04 0.001 -0.002 0.003"/>
        <joint name="slide" type="slide" axis="0 1 1" range="-0.2 0.3" ref="0.1"/>
        <body name="three" pos="0 0 0.2" xyaxes="0 1 0 -1 0.1 0">
          <inertial pos="0 0 0.1" mass="0.7" diaginertia="0.002 0.003 0.004" euler="15 -25 35"/>
          <joint name="wrist" axis="1 0 0" pos="0.02 -0.03 0.05" ref="25"/>
          <body name="flange" pos="0 0 0.1" zaxis="1 0 1">
            <inertial pos="0 0.01 0.02" mass="0.2" diaginertia="0.0002 0.0003 0.0004" axisangle="0 1 1 50"/>
            <site name="tool" pos="0 0 0.05" euler="0 90 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

SEVERAL_JOINTS = """\
<mujoco model="wrist">
  <compiler angle="radian" eulerseq="zyx"/>
  <worldbody>
    <body name="hand" pos="0 0 1" euler="0.3 0.2 0.1">
      <inertial pos="0.1 0.05 0.2" mass="3" diaginertia="0.05 0.06 0.03"/>
      <joint name="roll" axis="1 0 0" pos="0 0.1 0" ref="0.3"/>
      <joint name="lift" type="slide" axis="0 0 1" ref="-0.1"/>
      <joint name="pitch" axis="0 1 0" pos="0.05 0 -0.1"/>
      <joint name="yaw" axis="0 0.6 0.8" pos="0.01 0.02 0.03" ref="-0.7" armature="0.01"/>
      <body name="finger" pos="0.2 0 0">
        <inertial pos="0.05 0 0" mass="0.4" diaginertia="0.001 0.002 0.0015"/>
        <joint name="a" axis="0 1 0"/>
        <joint name="b" axis="1 0 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

DEFAULTS = """\
<mujoco model="defaults">
  <compiler angle="degree" autolimits="true"/>
  <default>
    <joint axis="0 1 0" armature="0.1" damping="1"/>
    <default class="heavy">
      <joint axis="0 0 1" armature="0.5" frictionloss="2"/>
      <default class="light"><joint damping="0.25" range="-30 60"/></default>
    </default>
  </default>
  <worldbody>
    <body name="base" pos="0 0 0.5">
      <inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>
      <body name="upper" childclass="heavy">
        <inertial pos="0 0 0.2" mass="4" diaginertia="0.1 0.12 0.03"/>
        <joint name="j1"/>
        <body name="fore" pos="0 0 0.4">
          <inertial pos="0.02 0 0.15" mass="2" diaginertia="0.02 0.025 0.01"/>
          <joint name="j2" class="light"/>
          <body name="tip" pos="0 0 0.3" childclass="main">
            <inertial pos="0 0 0.05" mass="0.5" diaginertia="0.001 0.001 0.0008"/>
            <joint name="j3" axis="1 0 0" armature="0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="j1" gear="50" forcerange="-2 2"/><position joint="j2" kp="100"/></actuator>
</mujoco>
"""

MESHES = """\
<mujoco model="meshes">
  <compiler meshdir="missing" texturedir="missing"/>
  <asset>
    <mesh name="shell" file="shell.stl"/><texture name="wood" type="2d" file="wood.png"/>
    <material name="oak" texture="wood"/>
  </asset>
  <worldbody>
    <geom type="mesh" mesh="shell"/>
    <body name="link">
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.02 0.015"/>
      <joint name="hinge" axis="0 1 0"/>
      <geom name="skin" type="mesh" mesh="shell" material="oak"/>
      <body name="end" pos="0.3 0 0">
        <inertial pos="0.1 0 0" mass="0.5" diaginertia="0.001 0.002 0.0015"/>
        <joint name="end" axis="0 0 1"/>
        <geom name="pad" type="box" size="0.1 0.1 0.1"/>
        <site name="end"/>
      </body>
    </body>
  </worldbody>
  <contact><pair geom1="skin" geom2="pad"/><exclude body1="link" body2="end"/></contact>
  <tendon><spatial name="cable"><site site="end"/><geom geom="pad"/><site site="end"/></spatial></tendon>
  <actuator><motor tendon="cable"/></actuator>
  <sensor><touch site="end"/><tendonpos tendon="cable"/></sensor>
  <keyframe><key qpos="0 0"/></keyframe>
</mujoco>
"""

GEOMS = """\
<mujoco model="geoms">
  <compiler inertiafromgeom="auto"/>
  <worldbody>
    <body name="a" pos="0 0 0.2">
      <joint name="a" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.1 0 0.4" size="0.04" density="700"/>
      <geom type="sphere" pos="0 0 0.4" size="0.06" mass="0.8"/>
      <body name="b" pos="0.1 0 0.4">
        <joint name="b" axis="1 0 0"/>
        <geom type="box" size="0.05 0.04 0.1" pos="0 0 0.1" euler="10 20 30"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

EQUALITIES = """\
<mujoco model="equalities">
  <worldbody>
    <body name="crank">
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.001 0.01 0.01"/>
      <joint name="crank" axis="0 0 1"/>
      <body name="rod" pos="0.2 0 0" euler="0 0 40">
        <inertial pos="0.25 0 0" mass="1.2" diaginertia="0.001 0.02 0.02"/>
        <joint name="rod" axis="0 0 1"/>
      </body>
    </body>
    <body name="rocker" pos="0.5 -0.3 0">
      <inertial pos="0.1 0 0" mass="0.8" diaginertia="0.001 0.01 0.01"/>
      <joint name="rocker" axis="0 0 1"/>
    </body>
    <body name="left" pos="0 0 1">
      <inertial pos="0.1 0 0" mass="0.3" diaginertia="0.001 0.001 0.001"/>
      <joint name="left" type="slide" axis="1 0 0" ref="0.02"/>
    </body>
    <body name="right" pos="0 0 1">
      <inertial pos="-0.1 0 0" mass="0.3" diaginertia="0.001 0.001 0.001"/>
      <joint name="right" type="slide" axis="-1 0 0" ref="0.03"/>
    </body>
    <body name="brake" pos="0 1 0">
      <inertial pos="0.1 0 0" mass="0.3" diaginertia="0.001 0.001 0.001"/>
      <joint name="brake" axis="0 0 1"/>
    </body>
  </worldbody>
  <equality>
    <connect name="pin" body1="rod" body2="rocker" anchor="0.3 0 0"/>
    <joint joint1="right" joint2="left" polycoef="0.01 0.5 0 0 0"/>
    <joint joint1="brake" polycoef="0.4 0 0 0 0"/>
    <connect name="idle" body1="left" body2="crank" anchor="0 0 0" active="false"/>
  </equality>
  <actuator><motor joint="crank"/></actuator>
</mujoco>
"""

WELDED = """\
<mujoco model="welded">
  <option><flag gravity="disable"/></option>
  <worldbody>
    <body name="left" pos="0 0.2 0">
      <inertial pos="0 0 0.2" mass="1" diaginertia="0.02 0.02 0.001"/>
      <joint name="left" axis="1 0 0"/>
      <site name="on_left" pos="0 0 0.5" euler="0 0 90"/>
    </body>
    <body name="right" pos="0 -0.2 0" euler="0 0 30">
      <inertial pos="0 0 0.3" mass="1.5" diaginertia="0.03 0.03 0.002"/>
      <joint name="right" axis="1 0 0"/>
      <body name="bar" pos="0 0 0.5"><inertial pos="0 0 0" mass="0.2" diaginertia="0.001 0.001 0.001"/>
        <joint name="bar" axis="1 0 0"/><joint name="twist" axis="0 0 1"/>
        <site name="on_bar" pos="0 0.4 0"/>
      </body>
    </body>
  </worldbody>
  <equality>
    <weld name="by_bodies" body1="left" body2="bar"/>
    <weld name="by_sites" site1="on_left" site2="on_bar"/>
  </equality>
</mujoco>
"""

INCLUDING = """\
<mujoco model="including">
  <compiler settotalmass="7"/>
  <include file="parts/settings.xml"/>
  <worldbody>
    <frame pos="0 0 1" euler="0 90 0">
      <body name="first">
        <inertial pos="0 0.1 0" mass="1" diaginertia="0.01 0.02 0.015"/>
        <joint name="first" axis="0 0 1"/>
        <include file="parts/hand.xml"/>
      </body>
    </frame>
    <replicate count="2" euler="0 0 90">
      <body name="leg" pos="0.5 0 0">
        <inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.001"/>
        <joint name="leg" axis="0 1 0"/>
      </body>
    </replicate>
  </worldbody>
</mujoco>
"""

ATTACHING = """\
<mujoco model="attaching">
  <asset><model name="grip" file="parts/grip.xml"/></asset>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <inertial pos="0 0.1 0" mass="2" diaginertia="0.1 0.1 0.15"/>
      <joint name="arm" axis="0 1 0" armature="0.3"/>
      <frame pos="0 0 0.5" euler="0 0 90"><attach model="grip" body="palm" prefix="grip_"/></frame>
    </body>
  </worldbody>
</mujoco>
"""

INCLUDED = {
    "settings.xml": '<mujoco><option gravity="1 2 3"/><default><joint armature="0.125"/></default></mujoco>\n',
    "hand.xml": """\
<mujocoinclude>
  <body name="hand" pos="0.1 0.2 0.3">
    <inertial pos="0 0 0.1" mass="2" diaginertia="0.02 0.02 0.01"/>
    <joint axis="1 0 0" damping="2"/>
  </body>
</mujocoinclude>
""",
    "grip.xml": """\
<mujoco model="grip">
  <default><joint damping="0.1" armature="0.01"/></default>
  <worldbody>
    <body name="palm" pos="0.1 0 0">
      <inertial pos="0 0 0.02" mass="0.5" diaginertia="0.001 0.001 0.001"/>
      <joint name="spin" axis="0 0 1"/>
      <body name="finger" pos="0.05 0 0">
        <inertial pos="0 0 0.02" mass="0.1" diaginertia="0.0001 0.0001 0.0001"/>
        <joint name="finger" type="slide" axis="1 0 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
""",
}

FILES = {
    "forms": FORMS,
    "several_joints": SEVERAL_JOINTS,
    "defaults": DEFAULTS,
    "meshes": MESHES,
    "geoms": GEOMS,
    "equalities": EQUALITIES,
    "welded": WELDED,
    "including": INCLUDING,
    "attaching": ATTACHING,
}


def written(folder, name):
    """The file of this name in a folder, with those that it includes."""
    (folder / "parts").mkdir(exist_ok=True)
    for part, text in INCLUDED.items():
        (folder / "parts" / part).write_text(text)
    path = folder / f"{name}.xml"
    path.write_text(FILES[name])
    return path


def without_meshes(path):
    """MuJoCo's own model of a file, without the parts that need mesh files."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of deprecated attributes
        spec = mujoco.MjSpec.from_file(str(path))
        return _compiled(spec)


def _compiled(spec):
    if spec.meshes:
        for kind in ("sensors", "actuators", "tendons", "pairs", "geoms", "materials", "textures", "meshes"):
            for element in list(getattr(spec, kind)):
                spec.delete(element)
    return spec.compile()


class Rigid:
    """The rigid-body dynamics of MuJoCo's model: no springs, damping, friction, limits, equalities and actuators;
    armature stays.

    Arrays have the order of the joints with these names; joint_K is that of number K without a name.
    """

    def __init__(self, native, joints):
        self.native, self.data = native, mujoco.MjData(native)
        bits = mujoco.mjtDisableBit
        native.opt.disableflags |= bits.mjDSBL_CONSTRAINT | bits.mjDSBL_CONTACT | bits.mjDSBL_ACTUATION
        native.jnt_stiffness[:] = 0
        native.dof_damping[:] = 0
        named = {native.joint(number).name or f"joint_{number}": native.joint(number) for number in range(native.njnt)}
        found = [named[name] for name in joints]
        self.positions = np.array([joint.qposadr[0] for joint in found])
        self.columns = np.array([joint.dofadr[0] for joint in found])
        self.armature = native.dof_armature[self.columns]

    def torques(self, q, v, a):
        """τ (N, n) of mj_inverse; joints that have no column rest at their `ref`."""
        answers = []
        for row in zip(q, v, a, strict=True):
            self.data.qpos[:] = self.native.qpos0
            self.data.qpos[self.positions], self.data.qvel[self.columns], self.data.qacc[self.columns] = row
            mujoco.mj_inverse(self.native, self.data)
            answers.append(self.data.qfrc_inverse[self.columns].copy())
        return np.array(answers)

    def accelerations(self, q, v, tau):
        """a (N, n) of mj_forward."""
        answers = []
        for row in zip(q, v, tau, strict=True):
            self.data.qpos[:] = self.native.qpos0
            self.data.qpos[self.positions], self.data.qvel[self.columns], self.data.qfrc_applied[self.columns] = row
            mujoco.mj_forward(self.native, self.data)
            answers.append(self.data.qacc[self.columns].copy())
        return np.array(answers)
