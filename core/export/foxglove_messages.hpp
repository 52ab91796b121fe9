#pragma once

#include <google/protobuf/message.h>

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/geometry/se3.hpp"

namespace stillpoint {

// Messages of Foxglove's schemas (github.com/foxglove/schemas, names and field numbers), made without
// generated code: Foxglove, Rerun and PlotJuggler know them by name.

/// Writes fields of a message by their names. Refers to the message.
class MessageFields {
 public:
  explicit MessageFields(google::protobuf::Message& message) : message_(&message) {}

  MessageFields& text(const char* field, const std::string& value);  ///< also bytes
  MessageFields& number(const char* field, double value);
  MessageFields& count(const char* field, std::uint32_t value);  ///< fixed32
  MessageFields& choice(const char* field, int value);           ///< of an enumeration
  MessageFields& numbers(const char* field, std::span<const double> values);
  MessageFields& time(const char* field, std::uint64_t ns);
  MessageFields& vector(const char* field, const Eigen::Vector3d& value);
  MessageFields& rotation(const char* field, const Eigen::Matrix3d& value);
  MessageFields& pose(const char* field, const Pose& value);
  /// A message within.
  [[nodiscard]] MessageFields within(const char* field);
  /// One more of a list of messages.
  [[nodiscard]] MessageFields add(const char* field);

 private:
  google::protobuf::Message* message_;
};

/// @param name without "foxglove.": "CompressedImage"
[[nodiscard]] std::unique_ptr<google::protobuf::Message> make_foxglove_message(const std::string& name);

/// The FileDescriptorSet that describes all of them, as an MCAP schema holds it.
[[nodiscard]] std::string foxglove_descriptors();

}  // namespace stillpoint
