// Archives and bags from the command line, opened as they were downloaded.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/support/log_writer.hpp"
#include "tests/support/message_writer.hpp"

namespace stillpoint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kRecordedFrames = 8;

class RecordingCli : public ::testing::Test {
 protected:
  RecordingCli() {
    write_archive(places.path("small.tgz"), sequence.path(), "tgz", "small");
    for (int i = 0; i < kRecordedFrames; ++i) {
      const std::int64_t stamp = std::llround(SmallSequence::stamp(i) * 1e4) * 100'000;
      cv::Mat depth;
      cv::imread(sequence.path(SmallSequence::depth(i)), cv::IMREAD_UNCHANGED)
          .convertTo(depth, CV_32F, 1.0 / SmallSequence::kDepthScale);
      const InfoExample info{SmallSequence::kWidth, SmallSequence::kHeight, "plumb_bob", {0, 0, 0, 0, 0},
                             SmallSequence::kFocal, SmallSequence::kFocal,  159.5,       119.5};
      messages.push_back(
          {"/cam/color/camera_info", "sensor_msgs/CameraInfo", stamp, info_bytes(true, stamp, info)});
      messages.push_back(
          {"/cam/color/image_raw", "sensor_msgs/Image", stamp,
           image_bytes(true, stamp, "optical", "bgr8", cv::imread(sequence.path(SmallSequence::colour(i))))});
      messages.push_back({"/cam/aligned_depth_to_color/image_raw", "sensor_msgs/Image", stamp,
                          image_bytes(true, stamp, "optical", "32FC1", depth)});
    }
    write_mcap(places.path("small.mcap"), messages, "zstd");
  }
  /// What a run's summary says.
  [[nodiscard]] nlohmann::json summary(const std::string& where) const {
    const CliResult result =
        run_cli({"run", where, "--method", "none", "--out", places.path("out"), "--force"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("warning"), std::string::npos) << result.err;
    return nlohmann::json::parse(places.read("out/summary.json"));
  }

  TemporaryFolder places{"recordings"};
  SmallSequence sequence{kRecordedFrames};
  std::vector<LogMessage> messages;  ///< of small.mcap
};

TEST_F(RecordingCli, RunsAreTheFolders) {
  const auto folder = summary(sequence.path());
  for (const char* name : {"small.tgz", "small.mcap"}) {
    const auto packed = summary(places.path(name));
    EXPECT_EQ(packed["run_hash"], folder["run_hash"]) << name;
    EXPECT_EQ(packed["source"]["name"], "small") << name;
    // A finished run finds its sequence again.
    const CliResult picture = run_cli({"snapshot", places.path("out"), "--panels", "input", "--frames", "2",
                                       "--force", "--out", places.path("pictures")});
    EXPECT_EQ(picture.exit_code, 0) << picture.err;
    EXPECT_EQ(picture.err, "") << name;
  }
}

TEST_F(RecordingCli, CheckListsTopicsAndOptionsChooseThem) {
  const CliResult check = run_cli({"check", places.path("small.mcap")});
  EXPECT_THAT(check.out,
              AllOf(HasSubstr("/cam/color/image_raw  sensor_msgs/Image  8 messages  read as colour"),
                    HasSubstr("/cam/aligned_depth_to_color/image_raw  sensor_msgs/Image  8 messages  read "
                              "as depth"),
                    HasSubstr("read as info")));
  const CliResult json = run_cli({"check", places.path("small.mcap"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["topics"].size(), 3U);
  expect_one_sentence(run_cli({"run", places.path("small.mcap"), "--topics", "depth=none"}),
                      "has colour frames only");
  expect_one_sentence(run_cli({"run", places.path("small.mcap"), "--topics", "depth=/nothing"}),
                      "has no topic /nothing; as depth it has /cam/aligned_depth_to_color/image_raw");
  expect_one_sentence(run_cli({"check", places.path("small.tgz"), "--topics", "depth=/a"}),
                      "--topics goes with a bag");
}

TEST_F(RecordingCli, TopicsAreKeptWithTheRun) {
  const CliResult run =
      run_cli({"run", places.path("small.mcap"), "--method", "none", "--out", places.path("out"), "--topics",
               "colour=cam/color/image_raw,info=none", "--camera", sequence.path("camera.toml")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(places.read("out/summary.json"));
  EXPECT_EQ(json["source"]["topics"], "colour=cam/color/image_raw,info=none");
  EXPECT_EQ(
      run_cli({"snapshot", places.path("out"), "--panels", "input", "--out", places.path("pictures")}).err,
      "");
}

TEST_F(RecordingCli, OfTwoTrackedBodiesTheCamerasIsTakenAndBothAreTold) {
  for (int i = 0; i < kRecordedFrames; ++i)
    for (const auto& [topic, metres_a_frame] :
         {std::pair{"/mocap/alice", 0.5},
          std::pair{"/mocap/camera", SmallSequence::kStep * SmallSequence::kDepth / SmallSequence::kFocal}}) {
      const std::int64_t stamp = std::llround(SmallSequence::stamp(i) * 1e4) * 100'000;
      Pose pose = Pose::Identity();
      pose.translation().x() = metres_a_frame * i;
      messages.push_back({topic, "geometry_msgs/PoseStamped", stamp, pose_bytes(true, stamp, "world", pose)});
    }
  write_mcap(places.path("two.mcap"), messages);
  const std::string told = "2 topics may be the camera's ground truth, /mocap/camera, /mocap/alice";
  const CliResult run =
      run_cli({"run", places.path("two.mcap"), "--method", "none", "--out", places.path("two")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr(told));
  EXPECT_LT(
      nlohmann::json::parse(places.read("two/summary.json"))["evaluation"]["ate"]["translation_m"]["rmse"],
      0.01);
  const CliResult check = run_cli({"check", places.path("two.mcap")});
  EXPECT_THAT(check.out,
              AllOf(HasSubstr("/mocap/camera  geometry_msgs/PoseStamped  8 messages  read as truth"),
                    HasSubstr(told), HasSubstr("`--topics truth=TOPIC` takes another")));
}

TEST_F(RecordingCli, DepthThatCannotBeReadIsNamed) {
  for (LogMessage& message : messages)
    if (message.topic.find("depth") != std::string::npos)
      message.bytes = image_bytes(true, message.time, "", "", cv::Mat());
  write_mcap(places.path("empty.mcap"), messages);
  expect_one_sentence(
      run_cli({"run", places.path("empty.mcap"), "--method", "none"}),
      "/cam/aligned_depth_to_color/image_raw: none of its first 8 messages says what image it holds");
}

TEST_F(RecordingCli, BadOnesEndInASentence) {
  places.write("small.bag", std::string("#ROSBAG V2.0\n") + std::string(50, '\xFF'));
  expect_one_sentence(run_cli({"run", places.path("small.bag")}), "small.bag: is damaged");
  places.write("small.zip", std::string("PK\3\4") + std::string(100, 'x'));
  expect_one_sentence(run_cli({"check", places.path("small.zip")}), "small.zip: cannot be unpacked");
  places.write("small.txt", std::string("hello"));
  expect_one_sentence(run_cli({"view", places.path("small.txt")}), "is a file, expected a folder");
}

TEST_F(RecordingCli, EvaluationTakesTruthFromAnArchive) {
  EXPECT_EQ(summary(sequence.path())["source"]["frames"], kRecordedFrames);
  const CliResult result =
      run_cli({"evaluate", places.path("small.tgz"), places.path("out/trajectory.txt"), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["matched"], kRecordedFrames);
}

}  // namespace
}  // namespace stillpoint
