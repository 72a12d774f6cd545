// Lets a world run in Gazebo's own physics and prints where every link of every model ends up.
//
//   gazebo_links PLUGIN WORLD.sdf STEPS   ->   x y z qx qy qz qw MODEL::LINK   (m, seen from the
//   world) a line

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <ignition/common/ImageHeightmap.hh>
#include <ignition/common/Mesh.hh>
#include <ignition/common/MeshManager.hh>
#include <ignition/math/eigen3/Conversions.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/heightmap/HeightmapShape.hh>
#include <ignition/physics/mesh/MeshShape.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/sdf.hh>

namespace common = ignition::common;
namespace physics = ignition::physics;
using ignition::math::eigen3::convert;

struct Features
    : physics::FeatureList<physics::sdf::ConstructSdfWorld, physics::ForwardStep,
                           physics::GetEntities, physics::LinkFrameSemantics,
                           physics::mesh::AttachMeshShapeFeature,
                           physics::heightmap::AttachHeightmapShapeFeature> {};

std::string path_of(const std::string &uri) {
  return uri.substr(std::string("file://").size());
}

// The engine leaves meshes, heightmaps and extrusions to its caller; this is what
// Gazebo Sim's physics system does about them.
template <typename Link>
bool attach(Link link, const sdf::Collision &collision) {
  const auto pose = convert(collision.RawPose());
  const auto *geometry = collision.Geom();
  if (const auto *mesh = geometry->MeshShape()) {
    const auto *loaded = common::MeshManager::Instance()->Load(path_of(mesh->Uri()));
    if (loaded == nullptr) return false;
    link->AttachMeshShape(collision.Name(), *loaded, pose, convert(mesh->Scale()));
  }
  if (const auto *heightmap = geometry->HeightmapShape()) {
    common::ImageHeightmap image;
    if (image.Load(path_of(heightmap->Uri())) < 0) return false;
    link->AttachHeightmapShape(collision.Name(), image, pose, convert(heightmap->Size()),
                               heightmap->Sampling());
  }
  // Its SDF library reads no polylines yet.
  if (geometry->Element()->HasElement("polyline")) {
    const auto first = geometry->Element()->GetElement("polyline");
    std::vector<std::vector<ignition::math::Vector2d>> outlines;
    for (auto polyline = first; polyline; polyline = polyline->GetNextElement("polyline")) {
      outlines.emplace_back();
      for (auto point = polyline->GetElement("point"); point; point = point->GetNextElement("point"))
        outlines.back().push_back(point->Get<ignition::math::Vector2d>());
    }
    const auto manager = common::MeshManager::Instance();
    manager->CreateExtrudedPolyline(collision.Name(), outlines, first->Get<double>("height"));
    const auto *made = manager->MeshByName(collision.Name());
    if (made == nullptr) return false;
    link->AttachMeshShape(collision.Name(), *made, pose);
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
  if (!engine) return 4;
  const auto &described = *root.WorldByIndex(0);
  auto world = engine->ConstructWorld(described);
  for (uint64_t m = 0; m < described.ModelCount(); ++m) {
    const auto &model = *described.ModelByIndex(m);
    for (uint64_t l = 0; l < model.LinkCount(); ++l) {
      const auto &link = *model.LinkByIndex(l);
      for (uint64_t c = 0; c < link.CollisionCount(); ++c) {
        if (!attach(world->GetModel(model.Name())->GetLink(link.Name()), *link.CollisionByIndex(c)))
          return 3;
      }
    }
  }

  physics::ForwardStep::Input input;
  physics::ForwardStep::State state;
  physics::ForwardStep::Output output;
  for (int step = 0; step < std::atoi(argv[3]); ++step) world->Step(output, state, input);

  std::cout << std::setprecision(9);
  for (uint64_t m = 0; m < described.ModelCount(); ++m) {
    const auto &model = *described.ModelByIndex(m);
    for (uint64_t l = 0; l < model.LinkCount(); ++l) {
      const auto name = model.LinkByIndex(l)->Name();
      const auto link = world->GetModel(model.Name())->GetLink(name);
      const auto pose = link->FrameDataRelativeToWorld().pose;
      const auto xyzw = Eigen::Quaterniond(pose.linear()).coeffs();
      std::cout << pose.translation().transpose() << ' ' << xyzw.transpose() << ' '
                << model.Name() << "::" << name << '\n';
    }
  }
}
