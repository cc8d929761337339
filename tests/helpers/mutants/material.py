"""What mutants are made of: a robot with every element of URDF, and odd numbers, names and elements."""

RICH = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- every element that a URDF file may have -->
<robot name="rich" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <material name="gray"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="world"/>
  <link name="base">
    <inertial><mass value="4"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual name="shell">
      <origin xyz="0 0 0.1" rpy="0 0 0"/>
      <geometry><mesh filename="package://rich/base.stl" scale="1 1 1"/></geometry>
      <material name="gray"/>
    </visual>
    <collision><origin xyz="0 0 0"/><geometry><cylinder radius="0.1" length="0.2"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/>
      <mass value="2.5"/>
      <inertia ixx="0.11" ixy="0.01" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"/>
    </inertial>
    <visual><geometry><box size="0.1 0.1 0.4"/></geometry><material name=""><color rgba="1 0 0 1"/></material></visual>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0 0 0.4"/>
      <mass value="1.5"/>
      <inertia ixx="5e-2" ixy="0" ixz="0" iyy=".06" iyz="0" izz="+0.02"/>
    </inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <link name="tool">
    <inertial>
      <origin xyz="0.01 0 0.05" rpy="0 0 1.5708"/>
      <mass value="0.3"/>
      <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0.0001" izz="0.004"/>
    </inertial>
  </link>
  <link name="finger">
    <inertial>
      <origin xyz="0 0.02 0.03"/><mass value="0.05"/>
      <inertia ixx="1e-5" ixy="0" ixz="0" iyy="1.2e-5" iyz="0" izz="1.1e-5"/>
    </inertial>
  </link>
  <link name="thumb">
    <inertial><mass value="0.06"/><inertia ixx="2e-5" ixy="0" ixz="0" iyy="2e-5" iyz="0" izz="2e-5"/></inertial>
  </link>
  <link name="camera"/>
  <joint name="mount" type="fixed">
    <origin xyz="0 0 0.1" rpy="0 0 0.2"/>
    <parent link="world"/>
    <child link="base"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 1.5708"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 0 -1"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
    <dynamics damping="0.5" friction="0.25"/>
    <safety_controller soft_lower_limit="-0.9" soft_upper_limit="1.9" k_position="10" k_velocity="5"/>
  </joint>
  <joint name="elbow" type="continuous">
    <origin xyz="0.3 0 0" rpy="1.5707963267948966 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0.6 0.8 0"/>
    <calibration rising="0.1"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="tool"/>
    <child link="finger"/>
    <axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/>
  </joint>
  <joint name="grasp" type="prismatic">
    <origin xyz="0 0.01 0"/>
    <parent link="tool"/>
    <child link="thumb"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/>
    <mimic joint="grip" multiplier="-1" offset="0.01"/>
  </joint>
  <joint name="eye" type="fixed"><parent link="tool"/><child link="camera"/></joint>
  <transmission name="drive">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="shoulder"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
    <actuator name="motor"><mechanicalReduction>100</mechanicalReduction></actuator>
  </transmission>
  <gazebo reference="fore"><mu1>0.2</mu1></gazebo>
</robot>
"""


def _words(*lines: str) -> list[str]:
    return " ".join(lines).split()


NUMBERS = [
    *_words(
        "0 -0 1 -1 2 0.5 1e3 1E-3 1e-9 1e-17 1e9 1e17 1e160 1e308 -1e308 1e400 1e-320 1e-400 4.9e-324 00.1",
        "3.14 1.5708 -1.57079 3.141592653589793 1.57e0 nan -nan inf -Infinity NaN 1. .5 +.5 -.5 . - e5 1e 1e+ --1",
        "1.57. 0.07, 0,07 1,2,3 0x10 0x1p3 1_0 1d3 1f 1; １ ٣ −1 ½ ${m} true None 1/2 pi 1e999999999",
    ),
    *("", " ", "1 2", "12 ", " 12", "\t1", "1\n", "1\u00a0", "$(arg m)"),
    *("9" * 400, "0." + "3" * 400, "0" * 300 + "1"),
]
NAMES = [
    *_words("a a/b Gelenk_ä 工具 universe world root_joint ${prefix}tool A < & ../../etc/passwd package://x 0 - nan"),
    *("", " ", "a b", "a\tb", '"', "x" * 300, "\u200b", "e\u0301", "\U0001f916"),
]
TYPES = [*_words("revolute continuous prismatic fixed floating planar spherical Revolute"), " fixed", ""]
TAGS = _words(
    "robot link joint inertial origin mass inertia axis limit dynamics mimic parent child visual collision",
    "geometry material Link inertials sensor group gazebo",
)
PIECES = (
    '<origin xyz="0.1 0.2 0.3" rpy="0.1 0 0"/>', '<origin xyz="1 0"/>', "<origin/>", '<mass value="1"/>', "<mass/>",
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>', "<inertial/>",
    '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>',
    '<axis xyz="0 1 1"/>', '<limit effort="1" velocity="1"/>', '<limit lower="1" upper="0" effort="1" velocity="1"/>',
    '<limit effort="-1" velocity="-1"/>', "<limit/>", '<dynamics damping="1"/>', "<dynamics/>",
    '<mimic joint="grip"/>', '<mimic joint="nowhere" multiplier="2"/>', "<mimic/>", "<safety_controller/>",
    '<safety_controller k_velocity="1"/>', '<calibration rising="x"/>', "<calibration/>", '<material name="gray"/>',
    '<material name="gray"><color rgba="1 1 1 1"/></material>', "<material/>", '<material name="m"/>', "<visual/>",
    "<collision/>", "<visual><geometry/></visual>", '<visual><geometry><sphere radius="x"/></geometry></visual>',
    '<collision><geometry><mesh filename="/dev/zero"/></geometry></collision>', "<geometry><cone/></geometry>",
    '<link name="new"/>', '<link name="new"><inertial><mass value="1"/></inertial></link>',
    '<joint name="new" type="fixed"><parent link="tool"/><child link="new"/></joint>', "<joint/>", "<link/>",
    '<joint name="more" type="revolute"/>', "<sensor/>", '<transmission name="t"/>', '<gazebo reference="base"/>',
    '<x:macro xmlns:x="http://www.ros.org/wiki/xacro" name="m"/>', "<!-- note -->", "<!---->", "<?hint x?>", "text",
    "<![CDATA[<link name='hidden'/>]]>", "&#60;", '<parent link="base"/>', '<child link="tool"/>', "<robot/>",
    '<robot name="inner"><link name="one"/></robot>', '<include filename="/etc/passwd"/>',
    '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd"/>',
)  # fmt: skip
