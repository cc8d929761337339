"""Drake: CalcInverseDynamics and CalcMassMatrix of a MultibodyPlant with the file as Parser reads it."""

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces
from robot_file import FILE_CAUSES, edited, root_link

PACKAGE = "drake"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge. All force elements count: gravity and damping."""
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(edited(file, undone))
    plant.mutable_gravity_field().set_gravity_vector(gravity)
    if root_link(file) != "world":  # which is the world to Drake
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(root_link(file)))
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def inverse_dynamics(q, v, a):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        return plant.CalcInverseDynamics(context, a, forces)

    def mass_matrix(q):
        plant.SetPositions(context, q)
        return plant.CalcMassMatrix(context)

    joints = [plant.get_joint(index) for index in plant.GetJointIndices()]
    return {
        "joint_names": [joint.name() for joint in joints if joint.num_velocities()],
        "inverse_dynamics": inverse_dynamics,
        "mass_matrix": mass_matrix,
    }
