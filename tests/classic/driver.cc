// Gazebo Classic as a program that does what its standard input says, a line at a time, and answers
// each with a line of JSON: with the server's own libraries, parser, physics, plugins and sensors.
//
//   world FILE                      load it; once
//   spawn FILE NAME X Y Z R P Y     a URDF or SDF model, by the topic that spawners use
//   step N                          iterations
//   state                           models with their links and joints
//   publish TOPIC TYPE TEXT         a message in the text format of protobuf; one of the types
//                                   of ignition.msgs goes to the topics of Ignition
//   param MODEL JOINT KEY VALUE     of a joint's first axis, as plugins set it: `vel`, `fmax`
//   listen TOPIC TYPE               keep the last message of a topic
//   heard TOPIC                     it, and how many came
//   sensors                         each sensor measures now, whatever its rate
//   picture SENSOR FILE             what a camera sees: its bytes, or floats of a depth camera
//
// Units are those of Gazebo: m, rad, kg, N. A quaternion is w, x, y, z. Poses and velocities are
// seen from the world, `cog` from the link; `inertia` (ixx, iyy, izz, ixy, ixz, iyz) is about the
// center of mass.
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include <google/protobuf/text_format.h>

#include <gazebo/gazebo.hh>
#include <gazebo/msgs/msgs.hh>
#include <gazebo/physics/physics.hh>
#include <gazebo/sensors/sensors.hh>
#include <gazebo/transport/transport.hh>
#include <ignition/msgs.hh>
#include <ignition/transport.hh>

namespace
{
using namespace gazebo;
using Clock = std::chrono::steady_clock;

const auto kPatience = std::chrono::seconds(60);
const auto kDelivery = std::chrono::milliseconds(200);  // of a message
const int kSame = 5;  // pictures, that nothing more comes

std::string Quoted(const std::string &text)
{
  std::ostringstream out;
  out << '"';
  for (const unsigned char c : text)
  {
    if (c == '"' || c == '\\')
      out << '\\' << c;
    else if (c < 0x20)
      out << "\\u" << std::hex << std::setw(4) << std::setfill('0') << int(c) << std::dec;
    else
      out << c;
  }
  out << '"';
  return out.str();
}

template <class... Numbers>
std::string List(Numbers... numbers)
{
  std::ostringstream out;
  out << std::setprecision(17) << '[';
  const char *comma = "";
  // JSON has no infinity and no NaN.
  ((std::isfinite(numbers) ? out << comma << numbers : out << comma << "null", comma = ","), ...);
  out << ']';
  return out.str();
}

std::string Vector(const ignition::math::Vector3d &v) { return List(v.X(), v.Y(), v.Z()); }

std::string Pose(const ignition::math::Pose3d &pose)
{
  const auto &p = pose.Pos();
  const auto &q = pose.Rot();
  return List(p.X(), p.Y(), p.Z(), q.W(), q.X(), q.Y(), q.Z());
}

std::string LinkState(const physics::Link &link)
{
  const auto inertial = link.GetInertial();
  const auto cog = inertial->CoG();
  const auto moments = inertial->MOI();  // seen from the link's axes
  std::ostringstream out;
  out << Quoted(link.GetScopedName()) << ":{\"pose\":" << Pose(link.WorldPose())
      << ",\"linear\":" << Vector(link.WorldLinearVel())
      << ",\"angular\":" << Vector(link.WorldAngularVel())
      << ",\"mass\":" << List(inertial->Mass()) << ",\"cog\":" << Vector(cog)
      << ",\"inertia\":"
      << List(moments(0, 0), moments(1, 1), moments(2, 2), moments(0, 1), moments(0, 2),
              moments(1, 2))
      << ",\"collisions\":" << link.GetCollisions().size() << '}';
  return out.str();
}

std::string JointState(const physics::Joint &joint)
{
  auto &changeable = const_cast<physics::Joint &>(joint);
  const auto parent = changeable.GetParent(), child = changeable.GetChild();
  std::ostringstream out;
  out << Quoted(joint.GetScopedName()) << ":{\"parent\":"
      << Quoted(parent ? parent->GetScopedName() : "world")
      << ",\"child\":" << Quoted(child ? child->GetScopedName() : "world") << ",\"axes\":[";
  for (unsigned int axis = 0; axis < joint.DOF(); ++axis)
    out << (axis ? "," : "") << "{\"position\":" << List(joint.Position(axis))
        << ",\"velocity\":" << List(changeable.GetVelocity(axis))
        << ",\"limits\":" << List(joint.LowerLimit(axis), joint.UpperLimit(axis))
        << ",\"axis\":" << Vector(joint.GlobalAxis(axis)) << '}';
  out << "]}";
  return out.str();
}

void Describe(const physics::ModelPtr &model, std::string &links, std::string &joints)
{
  for (const auto &link : model->GetLinks())
    links += (links.empty() ? "" : ",") + LinkState(*link);
  for (const auto &joint : model->GetJoints())
    joints += (joints.empty() ? "" : ",") + JointState(*joint);
  for (const auto &nested : model->NestedModels())
    Describe(nested, links, joints);
}

// The last message of a topic.
class Topic
{
 public:
  void Keep(const std::string &raw)
  {
    const auto message = msgs::MsgFactory::NewMsg(this->type);
    if (!message || !message->ParseFromString(raw))
      return;
    const std::lock_guard<std::mutex> lock(this->mutex);
    ++this->count;
    google::protobuf::TextFormat::PrintToString(*message, &this->text);
  }

  std::string Answer()
  {
    const std::lock_guard<std::mutex> lock(this->mutex);
    return "{\"count\":" + std::to_string(this->count) + ",\"text\":" + Quoted(this->text) + "}";
  }

  std::string type;

 private:
  int count = 0;
  std::string text;
  std::mutex mutex;
};

class Driver
{
 public:
  std::string Do(const std::string &line)
  {
    std::istringstream words(line);
    std::string command;
    words >> command;
    if (command == "world")
    {
      std::string file;
      words >> file;
      this->world = loadWorld(file);
      if (!this->world)
        return "{\"error\":\"no world\"}";
      this->world->Physics()->SetRealTimeUpdateRate(0);  // as fast as it can
      this->node = transport::NodePtr(new transport::Node());
      this->node->Init(this->world->Name());
      return "{}";
    }
    if (!this->world)
      return "{\"error\":\"no world\"}";
    if (command == "spawn")
      return this->Spawn(words);
    if (command == "step")
    {
      unsigned int steps = 0;
      words >> steps;
      runWorld(this->world, steps);
      return "{\"time\":" + List(this->world->SimTime().Double()) + "}";
    }
    if (command == "state")
      return this->State();
    if (command == "publish")
      return this->Publish(words);
    if (command == "param")
      return this->SetParam(words);
    if (command == "listen")
      return this->Listen(words);
    if (command == "heard")
    {
      std::string topic;
      words >> topic;
      return this->topics[topic].Answer();
    }
    if (command == "sensors")
      return this->Sensors();
    if (command == "picture")
      return this->Picture(words);
    return "{\"error\":\"unknown command\"}";
  }

 private:
  // As gazebo_ros's factory does it: the text becomes SDF, gets its name and is sent with its pose.
  std::string Spawn(std::istringstream &words)
  {
    std::string file, name;
    ignition::math::Vector3d position, rpy;
    words >> file >> name >> position >> rpy;
    std::ifstream stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    sdf::SDFPtr description(new sdf::SDF());
    sdf::init(description);
    if (!sdf::readString(text.str(), description))
      return "{\"error\":\"refused by sdformat\"}";
    if (!description->Root()->HasElement("model"))
      return "{\"error\":\"no model\"}";
    description->Root()->GetElement("model")->GetAttribute("name")->SetFromString(name);
    msgs::Factory message;
    message.set_sdf(description->ToString());
    msgs::Set(message.mutable_pose(), {position, ignition::math::Quaterniond(rpy)});
    auto publisher = this->node->Advertise<msgs::Factory>("~/factory");
    publisher->WaitForConnection();
    publisher->Publish(message);
    const auto end = Clock::now() + kPatience;
    while (Clock::now() < end)
    {
      if (this->world->ModelByName(name))
        return "{}";
      runWorld(this->world, 1);  // factory messages are read between steps
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return "{\"error\":\"not spawned\"}";
  }

  std::string State()
  {
    std::string out = "{\"time\":" + List(this->world->SimTime().Double()) + ",\"models\":{";
    const char *comma = "";
    for (const auto &model : this->world->Models())
    {
      std::string links, joints;
      Describe(model, links, joints);
      out += comma + Quoted(model->GetName()) + ":{\"pose\":" + Pose(model->WorldPose()) +
             ",\"links\":{" + links + "},\"joints\":{" + joints + "}}";
      comma = ",";
    }
    return out + "}}";
  }

  std::string Publish(std::istringstream &words)
  {
    std::string topic, type, text;
    words >> topic >> type;
    std::getline(words, text);
    if (type.rfind("ignition.msgs.", 0) == 0)
      return this->PublishToIgnition(topic, type, text);
    const auto message = msgs::MsgFactory::NewMsg(type);
    if (!message || !google::protobuf::TextFormat::ParseFromString(text, message.get()))
      return "{\"error\":\"no such message\"}";
    auto &publisher = this->publishers[topic];
    if (!publisher)
      publisher = this->node->Advertise(topic, type);
    publisher->WaitForConnection(common::Time(5, 0));
    publisher->Publish(*message, true);
    // Subscribers have their own thread.
    std::this_thread::sleep_for(kDelivery);
    return "{}";
  }

  std::string PublishToIgnition(const std::string &topic, const std::string &type,
                                const std::string &text)
  {
    // Ignition's own factory makes messages of Gazebo, which have the same names.
    const auto kind = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(type);
    if (!kind)
      return "{\"error\":\"no such message\"}";
    const std::unique_ptr<google::protobuf::Message> message(
        google::protobuf::MessageFactory::generated_factory()->GetPrototype(kind)->New());
    auto &publisher = this->ignition_publishers[topic];
    if (!publisher)
      publisher = this->ignition_node.Advertise(topic, type);
    if (!google::protobuf::TextFormat::ParseFromString(text, message.get()) ||
        !publisher.Publish(*message))
      return "{\"error\":\"no such message\"}";
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return "{}";
  }

  // Between two steps, as plugins do it at the beginning of one.
  std::string SetParam(std::istringstream &words)
  {
    std::string name, joint_name, key;
    double value = 0;
    words >> name >> joint_name >> key >> value;
    const auto model = this->world->ModelByName(name);
    const auto joint = model ? model->GetJoint(joint_name) : nullptr;
    if (!joint || !joint->SetParam(key, 0, value))
      return "{\"error\":\"no such joint or parameter\"}";
    return "{}";
  }

  std::string Listen(std::istringstream &words)
  {
    std::string topic, type;
    words >> topic >> type;
    auto &heard = this->topics[topic];
    heard.type = type;
    this->subscribers.push_back(this->node->Subscribe(topic, &Topic::Keep, &heard));
    std::this_thread::sleep_for(kDelivery);
    return "{}";
  }

  // Some get what they measure from other parts of the server, whose messages have their own thread.
  std::string Sensors()
  {
    const auto &manager = sensors::SensorManager::Instance();
    sensors::run_once(true);  // gets new ones ready
    std::this_thread::sleep_for(kDelivery);
    std::string out = "{\"sensors\":[";
    const char *comma = "";
    for (const auto &sensor : manager->GetSensors())
    {
      sensor->Update(true);
      out += comma + Quoted(sensor->ScopedName());
      comma = ",";
    }
    std::this_thread::sleep_for(kDelivery);
    return out + "]}";
  }

  // The scene of a camera hears of models, lights and meshes by and by: the same picture several
  // times is the whole.
  std::string Picture(std::istringstream &words)
  {
    std::string name, file;
    words >> name >> file;
    sensors::run_once(true);  // gets new ones ready
    const auto sensor = sensors::get_sensor(name);
    if (!sensor)
      return "{\"error\":\"no sensor\"}";
    // Of a depth camera there is only what something listens to.
    const auto subscriber = this->node->Subscribe(sensor->Topic(), &Driver::Ignore, this);
    const auto end = Clock::now() + kPatience;
    std::string picture;
    for (int same = 0; same < kSame && Clock::now() < end;)
    {
      runWorld(this->world, 1);  // a sensor takes one picture at a time
      sensors::run_once(true);
      const auto seen = Seen(sensor);
      same = !seen.empty() && seen == picture ? same + 1 : 0;
      picture = seen;
      std::this_thread::sleep_for(kDelivery);
    }
    if (picture.empty())
      return "{\"error\":\"no picture\"}";
    std::ofstream(file, std::ios::binary) << picture;
    return "{\"bytes\":" + std::to_string(picture.size()) + "}";
  }

  void Ignore(ConstImageStampedPtr &) {}

  static std::string Seen(const sensors::SensorPtr &sensor)
  {
    const char *data = nullptr;
    std::size_t pixels = 0, size = 3;
    if (const auto depth = std::dynamic_pointer_cast<sensors::DepthCameraSensor>(sensor))
    {
      data = reinterpret_cast<const char *>(depth->DepthData());
      pixels = depth->ImageWidth() * depth->ImageHeight();
      size = sizeof(float);
    }
    else if (const auto camera = std::dynamic_pointer_cast<sensors::CameraSensor>(sensor))
    {
      data = reinterpret_cast<const char *>(camera->ImageData());
      pixels = camera->ImageWidth() * camera->ImageHeight();
    }
    return data ? std::string(data, pixels * size) : std::string();
  }

  physics::WorldPtr world;
  transport::NodePtr node;
  ignition::transport::Node ignition_node;
  std::map<std::string, ignition::transport::Node::Publisher> ignition_publishers;
  std::map<std::string, transport::PublisherPtr> publishers;
  std::list<transport::SubscriberPtr> subscribers;
  std::map<std::string, Topic> topics;
};

// The network namespace of this process alone has a loopback that is down.
void RaiseLoopback()
{
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  const int any = socket(AF_INET, SOCK_DGRAM, 0);
  ioctl(any, SIOCGIFFLAGS, &request);
  request.ifr_flags |= IFF_UP;
  ioctl(any, SIOCSIFFLAGS, &request);
  close(any);
}
}  // namespace

int main(int argc, char **argv)
{
  // What the libraries print goes where errors go.
  FILE *answers = fdopen(dup(STDOUT_FILENO), "w");
  dup2(STDERR_FILENO, STDOUT_FILENO);
  RaiseLoopback();
  if (!gazebo::setupServer(argc, argv))
    return 1;
  Driver driver;
  for (std::string line; std::getline(std::cin, line);)
  {
    std::fputs((driver.Do(line) + "\n").c_str(), answers);
    std::fflush(answers);
  }
  std::_Exit(0);  // taking the server down takes seconds, and may crash
}
