#include "core/export/foxglove_messages.hpp"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/timestamp.pb.h>

#include <Eigen/Geometry>
#include <map>
#include <stdexcept>

namespace stillpoint {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::FieldDescriptor;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorProto;

constexpr const char* kPackage = "foxglove";

/// A field of a message. `type` is a scalar's name, or a message's; "[]" behind it makes a list.
struct FieldRow {
  const char* message;
  const char* field;
  int number;
  const char* type;
};

constexpr FieldRow kFields[] = {
    {"Vector3", "x", 1, "double"},
    {"Vector3", "y", 2, "double"},
    {"Vector3", "z", 3, "double"},
    {"Quaternion", "x", 1, "double"},
    {"Quaternion", "y", 2, "double"},
    {"Quaternion", "z", 3, "double"},
    {"Quaternion", "w", 4, "double"},
    {"Pose", "position", 1, "Vector3"},
    {"Pose", "orientation", 2, "Quaternion"},
    {"Point2", "x", 1, "double"},
    {"Point2", "y", 2, "double"},
    {"Color", "r", 1, "double"},
    {"Color", "g", 2, "double"},
    {"Color", "b", 3, "double"},
    {"Color", "a", 4, "double"},
    {"CompressedImage", "timestamp", 1, "google.protobuf.Timestamp"},
    {"CompressedImage", "frame_id", 4, "string"},
    {"CompressedImage", "data", 2, "bytes"},
    {"CompressedImage", "format", 3, "string"},
    {"RawImage", "timestamp", 1, "google.protobuf.Timestamp"},
    {"RawImage", "frame_id", 7, "string"},
    {"RawImage", "width", 2, "fixed32"},
    {"RawImage", "height", 3, "fixed32"},
    {"RawImage", "encoding", 4, "string"},
    {"RawImage", "step", 5, "fixed32"},
    {"RawImage", "data", 6, "bytes"},
    {"CameraCalibration", "timestamp", 1, "google.protobuf.Timestamp"},
    {"CameraCalibration", "frame_id", 9, "string"},
    {"CameraCalibration", "width", 2, "fixed32"},
    {"CameraCalibration", "height", 3, "fixed32"},
    {"CameraCalibration", "distortion_model", 4, "string"},
    {"CameraCalibration", "D", 5, "double[]"},
    {"CameraCalibration", "K", 6, "double[]"},
    {"CameraCalibration", "R", 7, "double[]"},
    {"CameraCalibration", "P", 8, "double[]"},
    {"FrameTransform", "timestamp", 1, "google.protobuf.Timestamp"},
    {"FrameTransform", "parent_frame_id", 2, "string"},
    {"FrameTransform", "child_frame_id", 3, "string"},
    {"FrameTransform", "translation", 4, "Vector3"},
    {"FrameTransform", "rotation", 5, "Quaternion"},
    {"FrameTransforms", "transforms", 1, "FrameTransform[]"},
    {"PosesInFrame", "timestamp", 1, "google.protobuf.Timestamp"},
    {"PosesInFrame", "frame_id", 2, "string"},
    {"PosesInFrame", "poses", 3, "Pose[]"},
    {"PackedElementField", "name", 1, "string"},
    {"PackedElementField", "offset", 2, "fixed32"},
    {"PackedElementField", "type", 3, "NumericType"},
    {"PointCloud", "timestamp", 1, "google.protobuf.Timestamp"},
    {"PointCloud", "frame_id", 2, "string"},
    {"PointCloud", "pose", 3, "Pose"},
    {"PointCloud", "point_stride", 4, "fixed32"},
    {"PointCloud", "fields", 5, "PackedElementField[]"},
    {"PointCloud", "data", 6, "bytes"},
    {"PointsAnnotation", "timestamp", 1, "google.protobuf.Timestamp"},
    {"PointsAnnotation", "type", 2, "PointsAnnotationType"},
    {"PointsAnnotation", "points", 3, "Point2[]"},
    {"PointsAnnotation", "outline_color", 4, "Color"},
    {"PointsAnnotation", "thickness", 7, "double"},
    {"ImageAnnotations", "points", 2, "PointsAnnotation[]"},
    {"Log", "timestamp", 1, "google.protobuf.Timestamp"},
    {"Log", "level", 2, "LogLevel"},
    {"Log", "message", 3, "string"},
    {"Log", "name", 4, "string"},
};

/// Enumerations: the names of their values, from 0.
const std::map<std::string, std::vector<const char*>>& enumerations() {
  static const std::map<std::string, std::vector<const char*>> all = {
      {"NumericType",
       {"UNKNOWN_NUMERIC", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"}},
      {"PointsAnnotationType", {"UNKNOWN_POINTS", "POINTS", "LINE_LOOP", "LINE_STRIP", "LINE_LIST"}},
      {"LogLevel", {"UNKNOWN_LEVEL", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"}},
  };
  return all;
}

void set_type(std::string type, FieldDescriptorProto& field) {
  const bool list = type.ends_with("[]");
  if (list) type.resize(type.size() - 2);
  field.set_label(list ? FieldDescriptorProto::LABEL_REPEATED : FieldDescriptorProto::LABEL_OPTIONAL);
  static const std::map<std::string, FieldDescriptorProto::Type> kScalars = {
      {"double", FieldDescriptorProto::TYPE_DOUBLE},
      {"string", FieldDescriptorProto::TYPE_STRING},
      {"bytes", FieldDescriptorProto::TYPE_BYTES},
      {"fixed32", FieldDescriptorProto::TYPE_FIXED32}};
  if (const auto scalar = kScalars.find(type); scalar != kScalars.end()) {
    field.set_type(scalar->second);
    return;
  }
  field.set_type(enumerations().count(type) > 0 ? FieldDescriptorProto::TYPE_ENUM
                                                : FieldDescriptorProto::TYPE_MESSAGE);
  field.set_type_name(type.find('.') == std::string::npos ? std::string(".") + kPackage + "." + type
                                                          : "." + type);
}

FileDescriptorProto describe() {
  FileDescriptorProto file;
  file.set_name("foxglove/stillpoint.proto");
  file.set_package(kPackage);
  file.set_syntax("proto3");
  file.add_dependency("google/protobuf/timestamp.proto");
  for (const auto& [name, values] : enumerations()) {
    auto* type = file.add_enum_type();
    type->set_name(name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      auto* value = type->add_value();
      value->set_name(values[i]);
      value->set_number(static_cast<int>(i));
    }
  }
  google::protobuf::DescriptorProto* message = nullptr;
  for (const FieldRow& row : kFields) {
    if (message == nullptr || message->name() != row.message) {
      message = file.add_message_type();
      message->set_name(row.message);
    }
    FieldDescriptorProto* field = message->add_field();
    field->set_name(row.field);
    field->set_number(row.number);
    set_type(row.type, *field);
  }
  return file;
}

/// The messages' types. What is made of them lives no longer than this: until the program ends.
class Types {
 public:
  Types() : pool_(DescriptorPool::generated_pool()), file_(describe()) {
    (void)google::protobuf::Timestamp::descriptor();  // so that its file is in the pool
    if (pool_.BuildFile(file_) == nullptr)
      throw std::logic_error("the table of Foxglove's messages is no schema");
    factory_.SetDelegateToGeneratedFactory(true);
  }
  [[nodiscard]] std::unique_ptr<google::protobuf::Message> make(const std::string& name) {
    const auto* type = pool_.FindMessageTypeByName(std::string(kPackage) + "." + name);
    if (type == nullptr) throw std::logic_error("no message " + name);
    return std::unique_ptr<google::protobuf::Message>(factory_.GetPrototype(type)->New());
  }
  [[nodiscard]] std::string descriptors() const {
    google::protobuf::FileDescriptorSet set;
    google::protobuf::Timestamp::descriptor()->file()->CopyTo(set.add_file());
    *set.add_file() = file_;
    return set.SerializeAsString();
  }

 private:
  DescriptorPool pool_;
  FileDescriptorProto file_;
  google::protobuf::DynamicMessageFactory factory_;
};

Types& types() {
  static Types all;
  return all;
}

const FieldDescriptor* field_of(const google::protobuf::Message& message, const char* name) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr) throw std::logic_error(message.GetTypeName() + " has no field " + name);
  return field;
}

}  // namespace

MessageFields& MessageFields::text(const char* field, const std::string& value) {
  message_->GetReflection()->SetString(message_, field_of(*message_, field), value);
  return *this;
}

MessageFields& MessageFields::number(const char* field, double value) {
  message_->GetReflection()->SetDouble(message_, field_of(*message_, field), value);
  return *this;
}

MessageFields& MessageFields::count(const char* field, std::uint32_t value) {
  message_->GetReflection()->SetUInt32(message_, field_of(*message_, field), value);
  return *this;
}

MessageFields& MessageFields::choice(const char* field, int value) {
  message_->GetReflection()->SetEnumValue(message_, field_of(*message_, field), value);
  return *this;
}

MessageFields& MessageFields::numbers(const char* field, std::span<const double> values) {
  for (const double value : values)
    message_->GetReflection()->AddDouble(message_, field_of(*message_, field), value);
  return *this;
}

MessageFields& MessageFields::time(const char* field, std::uint64_t ns) {
  constexpr std::uint64_t kSecond = 1'000'000'000;  // ns
  auto& stamp = dynamic_cast<google::protobuf::Timestamp&>(
      *message_->GetReflection()->MutableMessage(message_, field_of(*message_, field)));
  stamp.set_seconds(static_cast<std::int64_t>(ns / kSecond));
  stamp.set_nanos(static_cast<std::int32_t>(ns % kSecond));
  return *this;
}

MessageFields& MessageFields::vector(const char* field, const Eigen::Vector3d& value) {
  within(field).number("x", value.x()).number("y", value.y()).number("z", value.z());
  return *this;
}

MessageFields& MessageFields::rotation(const char* field, const Eigen::Matrix3d& value) {
  const Eigen::Quaterniond q(value);
  within(field).number("x", q.x()).number("y", q.y()).number("z", q.z()).number("w", q.w());
  return *this;
}

MessageFields& MessageFields::pose(const char* field, const Pose& value) {
  within(field).vector("position", value.translation()).rotation("orientation", value.linear());
  return *this;
}

MessageFields MessageFields::within(const char* field) {
  return MessageFields(*message_->GetReflection()->MutableMessage(message_, field_of(*message_, field)));
}

MessageFields MessageFields::add(const char* field) {
  return MessageFields(*message_->GetReflection()->AddMessage(message_, field_of(*message_, field)));
}

std::unique_ptr<google::protobuf::Message> make_foxglove_message(const std::string& name) {
  return types().make(name);
}

std::string foxglove_descriptors() { return types().descriptors(); }

}  // namespace stillpoint
