#pragma once

#include <memory>
#include <string>

#include "core/sequence/bag/message_log.hpp"
#include "core/sequence/sequence_input.hpp"

namespace stillpoint {

/// A recording of messages as a sequence. Which topics it reads is said in topic_choice.hpp, which ground
/// truth in bag_truth.hpp, which images in bag_image.hpp.
///
/// Stamps are the messages' own, of their headers; where these stand still, the times of recording. The
/// camera is
/// `--camera`, or else CameraInfo; but a name that speaks of a known camera is believed before the made-up
/// calibration of a Kinect's driver. Depth of 16 bits is in millimetres, as ROS has it, or in RealSense's own
/// units where the recording tells them; floats are metres.
/// @throws InputError in one sentence where there are no colour images, and for topics asked for that do not
/// fit
[[nodiscard]] std::unique_ptr<SequenceInput> make_bag_input(std::unique_ptr<MessageLog> log,
                                                            const OpenOptions& options);

}  // namespace stillpoint
