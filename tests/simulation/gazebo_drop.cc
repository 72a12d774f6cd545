// Lets a model fall in Gazebo's own physics and prints where one of its links ends up.
//
//   gazebo_drop PLUGIN WORLD.sdf MODEL LINK STEPS   ->   x y z qx qy qz qw   (m, seen from the world)

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>

#include <ignition/common/Mesh.hh>
#include <ignition/common/MeshManager.hh>
#include <ignition/math/eigen3/Conversions.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/mesh/MeshShape.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/sdf.hh>

namespace physics = ignition::physics;

struct Features : physics::FeatureList<physics::sdf::ConstructSdfWorld, physics::ForwardStep,
                                       physics::GetEntities, physics::LinkFrameSemantics,
                                       physics::mesh::AttachMeshShapeFeature> {};

// The engine leaves meshes to its caller.
template <typename World>
bool attach_meshes(World &world, const sdf::Model &model) {
  for (uint64_t l = 0; l < model.LinkCount(); ++l) {
    const auto &link = *model.LinkByIndex(l);
    for (uint64_t c = 0; c < link.CollisionCount(); ++c) {
      const auto &collision = *link.CollisionByIndex(c);
      const auto *mesh = collision.Geom()->MeshShape();
      if (mesh == nullptr) continue;
      const auto file = mesh->Uri().substr(std::string("file://").size());
      const auto *loaded = ignition::common::MeshManager::Instance()->Load(file);
      if (loaded == nullptr) return false;
      world->GetModel(model.Name())->GetLink(link.Name())->AttachMeshShape(
          collision.Name(), *loaded, ignition::math::eigen3::convert(collision.RawPose()),
          ignition::math::eigen3::convert(mesh->Scale()));
    }
  }
  return true;
}

int main(int, char **argv) {
  sdf::Root root;
  const auto errors = root.Load(argv[2]);
  for (const auto &error : errors) std::cerr << error.Message() << '\n';
  if (!errors.empty()) return 1;
  ignition::plugin::Loader loader;
  const auto names = loader.LoadLib(argv[1]);
  if (names.empty()) return 2;
  const auto engine = physics::RequestEngine3d<Features>::From(loader.Instantiate(*names.begin()));
  const auto &described = *root.WorldByIndex(0);
  auto world = engine->ConstructWorld(described);
  if (!attach_meshes(world, *described.ModelByName(argv[3]))) return 3;

  physics::ForwardStep::Input input;
  physics::ForwardStep::State state;
  physics::ForwardStep::Output output;
  for (int step = 0; step < std::atoi(argv[5]); ++step) world->Step(output, state, input);

  const auto link = world->GetModel(argv[3])->GetLink(argv[4]);
  const auto pose = link->FrameDataRelativeToWorld().pose;
  const auto xyzw = Eigen::Quaterniond(pose.linear()).coeffs();
  std::cout << std::setprecision(9) << pose.translation().transpose() << ' ' << xyzw.transpose()
            << '\n';
}
