// Describes Foxglove's messages as descriptors of Protocol Buffers.
#include "tools/export/mcap/foxglove_schemas.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "tools/export/mcap/protobuf_message.hpp"

namespace cartvo {
namespace {

/// Values of FieldDescriptorProto.Type.
enum class Type : std::uint8_t {
  real = 1,
  int64 = 3,
  int32 = 5,
  text = 9,
  message = 11,
  bytes = 12,
  level = 14
};

struct Field {
  std::string name;
  std::uint32_t number;
  Type type;
  std::string message;  ///< full name of a field's message or enumeration, else empty
  bool is_repeated = false;
};

const char* const kTime = "google.protobuf.Timestamp";
const char* const kLevel = "foxglove.Log.Level";

/// All messages that cartvo writes, and those that they use, by full name.
const std::map<std::string, std::vector<Field>>& messages() {
  static const std::map<std::string, std::vector<Field>> kMessages = {
      {kTime, {{"seconds", 1, Type::int64, {}}, {"nanos", 2, Type::int32, {}}}},
      {"foxglove.Vector3", {{"x", 1, Type::real, {}}, {"y", 2, Type::real, {}}, {"z", 3, Type::real, {}}}},
      {"foxglove.Quaternion",
       {{"x", 1, Type::real, {}},
        {"y", 2, Type::real, {}},
        {"z", 3, Type::real, {}},
        {"w", 4, Type::real, {}}}},
      {"foxglove.Pose",
       {{"position", 1, Type::message, "foxglove.Vector3"},
        {"orientation", 2, Type::message, "foxglove.Quaternion"}}},
      {"foxglove.PoseInFrame",
       {{"timestamp", 1, Type::message, kTime},
        {"frame_id", 2, Type::text, {}},
        {"pose", 3, Type::message, "foxglove.Pose"}}},
      {"foxglove.Odometry",
       {{"timestamp", 1, Type::message, kTime},
        {"frame_id", 2, Type::text, {}},
        {"body_frame_id", 3, Type::text, {}},
        {"pose", 4, Type::message, "foxglove.Pose"},
        {"linear_velocity", 5, Type::message, "foxglove.Vector3"},
        {"angular_velocity", 6, Type::message, "foxglove.Vector3"},
        {"pose_covariance", 7, Type::real, {}, true},
        {"velocity_covariance", 8, Type::real, {}, true}}},
      {"foxglove.FrameTransform",
       {{"timestamp", 1, Type::message, kTime},
        {"parent_frame_id", 2, Type::text, {}},
        {"child_frame_id", 3, Type::text, {}},
        {"translation", 4, Type::message, "foxglove.Vector3"},
        {"rotation", 5, Type::message, "foxglove.Quaternion"}}},
      {"foxglove.CompressedVideo",
       {{"timestamp", 1, Type::message, kTime},
        {"frame_id", 2, Type::text, {}},
        {"data", 3, Type::bytes, {}},
        {"format", 4, Type::text, {}}}},
      {"foxglove.Log",
       {{"timestamp", 1, Type::message, kTime},
        {"level", 2, Type::level, kLevel},
        {"message", 3, Type::text, {}},
        {"name", 4, Type::text, {}}}},
  };
  return kMessages;
}

ProtobufMessage levelDescriptor() {
  ProtobufMessage descriptor;
  descriptor.text(1, "Level");
  std::uint64_t number = 0;
  for (const char* name : {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})
    descriptor.message(2, ProtobufMessage().text(1, name).number(2, number++));
  return descriptor;
}

ProtobufMessage fieldDescriptor(const Field& field) {
  constexpr std::uint64_t kOptional = 1, kRepeated = 3;
  ProtobufMessage descriptor;
  descriptor.text(1, field.name)
      .number(3, field.number)
      .number(4, field.is_repeated ? kRepeated : kOptional)
      .number(5, static_cast<std::uint64_t>(field.type));
  if (!field.message.empty()) descriptor.text(6, "." + field.message);
  return descriptor;
}

/// The file that Foxglove, or Google, defines the message in.
std::string fileOf(const std::string& message) {
  if (message == kTime) return "google/protobuf/timestamp.proto";
  return "foxglove/" + message.substr(message.rfind('.') + 1) + ".proto";
}

ProtobufMessage fileDescriptor(const std::string& message) {
  const std::size_t point = message.rfind('.');
  ProtobufMessage file, descriptor;
  file.text(1, fileOf(message)).text(2, message.substr(0, point));
  descriptor.text(1, message.substr(point + 1));
  std::set<std::string> dependencies;
  for (const Field& field : messages().at(message)) {
    descriptor.message(2, fieldDescriptor(field));
    if (field.type == Type::message) dependencies.insert(fileOf(field.message));
    if (field.type == Type::level) descriptor.message(4, levelDescriptor());
  }
  for (const std::string& dependency : dependencies)
    file.text(3, dependency);
  return file.message(4, descriptor).text(12, "proto3");
}

/// Adds the files of a message, those that it depends on first.
void addFiles(const std::string& message, std::set<std::string>& added, ProtobufMessage& files) {
  if (!added.insert(message).second) return;
  for (const Field& field : messages().at(message)) {
    if (field.type == Type::message) addFiles(field.message, added, files);
  }
  files.message(1, fileDescriptor(message));
}

}  // namespace

std::string foxgloveSchema(const std::string& message) {
  std::set<std::string> added;
  ProtobufMessage files;
  addFiles(message, added, files);
  return files.bytes();
}

}  // namespace cartvo
