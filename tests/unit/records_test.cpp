// What a run leaves in records.bin, and how it is opened again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/open_run.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/sequence/fingerprint.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kRecordedFrames = 5;

/// A short run of a small sequence, and its records, written and read.
class Records : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(run_folder());
    config_.run.method = "stillpoint";
    config_.run.check_removal = 1;
    config_.features.count = 300;
    source_ = open_sequence(sequence_.path());
    write();
  }

  void write() {
    origin_ = origin_of(*source_, sequence_.path(), {});
    RecordsWriter writer(run_folder(), origin_, config_);
    RunOptions options;
    options.keep_features = true;
    options.on_frame = [&](const FrameResult& frame) {
      writer.add(frame);
      masks_.push_back(frame.mask.clone());
    };
    run_ = run_sequence(*source_, config_, options);
    writer.finish(run_, source_->ground_truth());
  }

  [[nodiscard]] std::string run_folder() const { return out_.path("run"); }
  [[nodiscard]] std::string records() const { return "run/records.bin"; }
  [[nodiscard]] std::string error_when_opened() const {
    try {
      return open_run(run_folder()).recorded->cut_short;
    } catch (const InputError& error) {
      return error.what();
    }
  }

  /// … and all its frames looked at.
  [[nodiscard]] std::string error_when_read() const {
    return error_when_opened() + input_error_of([&] {
             const OpenedRun opened = open_run(run_folder());
             for (std::size_t i = 0; i < opened.recorded->run.records.size(); ++i)
               (void)opened.recorded->record(i);
           });
  }
  /// Where the first table lies in a whole file.
  [[nodiscard]] static std::uint64_t tables_of(const std::string& whole) {
    std::uint64_t tables = 0;
    std::memcpy(&tables, whole.data() + whole.size() - kRecordsFootBytes, sizeof(tables));
    return tables;
  }

  SmallSequence sequence_{kRecordedFrames};
  TemporaryFolder out_{"out"};
  Config config_;
  std::shared_ptr<const FrameSource> source_;
  SequenceOrigin origin_;
  RunResult run_;
  std::vector<cv::Mat> masks_;
};

TEST_F(Records, GiveBackEverythingToTheLastBit) {
  const OpenedRun opened = open_run(run_folder());
  EXPECT_EQ(opened.no_images, "");
  const RecordedRun& recorded = *opened.recorded;
  EXPECT_EQ(recorded.origin.where, sequence_.path());
  EXPECT_EQ(recorded.origin.camera.fx, SmallSequence::kFocal);
  EXPECT_EQ(to_toml(recorded.run.config), to_toml(config_));
  EXPECT_EQ(recorded.hash, run_hash(run_.records));
  ASSERT_EQ(recorded.run.records.size(), run_.records.size());
  for (std::size_t i = 0; i < run_.records.size(); ++i) {
    const FrameRecord back = recorded.record(i), record = run_.records[i];
    EXPECT_TRUE(recorded.run.records[i].features.empty());
    EXPECT_EQ(back.timestamp, record.timestamp);
    EXPECT_EQ(back.note, record.note);
    EXPECT_EQ(back.status, record.status);
    EXPECT_EQ(back.pose_start, record.pose_start);
    EXPECT_EQ(back.world_from_camera.matrix(), record.world_from_camera.matrix());
    EXPECT_EQ(back.camera_from_reference.matrix(), record.camera_from_reference.matrix());
    EXPECT_EQ(back.reference_keyframe, record.reference_keyframe);
    EXPECT_EQ(back.rms_px, record.rms_px);
    EXPECT_EQ(back.ms.total, record.ms.total);
    EXPECT_EQ(back.new_points, record.new_points);
    EXPECT_EQ(back.keyframe, record.keyframe);
    EXPECT_EQ(back.pose_covariance, record.pose_covariance);
    EXPECT_EQ(back.removal_check.nothing_removed_sigma_m, record.removal_check.nothing_removed_sigma_m);
    ASSERT_EQ(back.removal_check.nothing_removed.has_value(),
              record.removal_check.nothing_removed.has_value());
    if (record.removal_check.nothing_removed) {
      EXPECT_EQ(back.removal_check.nothing_removed->matrix(), record.removal_check.nothing_removed->matrix());
    }
    EXPECT_EQ(back.removal_check.truth_removed.has_value(), record.removal_check.truth_removed.has_value());
    ASSERT_EQ(back.features.size(), record.features.size());
    ASSERT_GT(back.features.size(), 50U);
    for (std::size_t f = 0; f < record.features.size(); ++f) {
      EXPECT_EQ(back.features[f].pixel, record.features[f].pixel);
      EXPECT_EQ(back.features[f].depth, record.features[f].depth);
      EXPECT_EQ(back.features[f].residual_px, record.features[f].residual_px);
      EXPECT_EQ(back.features[f].map_point, record.features[f].map_point);
      EXPECT_EQ(back.features[f].octave, record.features[f].octave);
      EXPECT_EQ(back.features[f].fate, record.features[f].fate);
      EXPECT_EQ(back.features[f].static_weight, record.features[f].static_weight);
    }
    const cv::Mat mask = recorded.mask(i);
    ASSERT_EQ(mask.size(), masks_[i].size());
    if (!mask.empty()) {
      EXPECT_EQ(cv::norm(mask, masks_[i], cv::NORM_INF), 0.0);
    }
  }
  ASSERT_EQ(recorded.run.trajectory.size(), run_.trajectory.size());
  EXPECT_EQ(recorded.run.trajectory.back().world_from_camera.matrix(),
            run_.trajectory.back().world_from_camera.matrix());
  ASSERT_EQ(recorded.run.points.size(), run_.points.size());
  EXPECT_EQ(recorded.run.points.back().position, run_.points.back().position);
  EXPECT_EQ(recorded.run.moved.size(), run_.moved.size());
  EXPECT_EQ(recorded.run.keyframes.size(), run_.keyframes.size());
  EXPECT_EQ(recorded.ground_truth.size(), source_->ground_truth().size());
  EXPECT_EQ(recorded.run.live.size(), run_.live.size());
}

TEST_F(Records, MovedWithTheirSequenceTheyStillFindIt) {
  const fs::path home = out_.path("moved");
  fs::create_directories(home);
  fs::create_directories(fs::path(run_folder()).parent_path());
  const std::string near = out_.path("near");
  fs::copy(sequence_.path(), near, fs::copy_options::recursive);
  source_ = open_sequence(near);
  origin_ = origin_of(*source_, near, {});
  {
    RecordsWriter writer(run_folder(), origin_, config_);
    const RunResult run =
        run_sequence(*source_, config_, {.on_frame = [&](const auto& f) { writer.add(f); }});
    writer.finish(run, source_->ground_truth());
  }
  fs::rename(near, home / "near");
  fs::rename(run_folder(), home / "run");
  const OpenedRun opened = open_run(home / "run");
  EXPECT_EQ(opened.no_images, "");
  EXPECT_TRUE(opened.source->read(0).readable());
}

TEST_F(Records, OfAFinishedRunStayUntilAnotherIsFinished) {
  out_.write("run/summary.json", std::string("{}\n"));  // what a finished run has
  const std::string whole = out_.read(records());
  {
    RecordsWriter writer(run_folder(), origin_, config_);
    writer.add({});
    EXPECT_EQ(out_.read(records()), whole);
  }
  EXPECT_EQ(out_.read(records()), whole);
  EXPECT_FALSE(fs::exists(out_.path("run/records.bin.part")));
  RecordsWriter writer(run_folder(), origin_, config_);
  writer.finish({}, {});
  writer.keep();
  EXPECT_NE(out_.read(records()), whole);
}

TEST_F(Records, AreWrittenByOneRunAtATime) {
  const auto begun = [this] { return std::make_unique<RecordsWriter>(run_folder(), origin_, config_); };
  const auto refused = [&]() -> std::string {
    try {
      (void)begun();
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  for (const bool earlier : {false, true}) {
    if (earlier) out_.write("run/summary.json", std::string("{}\n"));
    auto writer = begun();
    writer->add({});
    EXPECT_THAT(refused(), HasSubstr("run: another run is being written there")) << earlier;
    writer.reset();
    EXPECT_EQ(refused(), "") << "it has ended";
  }
}

TEST_F(Records, OfFramesThatDoNotFollowEachOtherAreRefused) {
  RecordsWriter writer(run_folder(), origin_, config_);
  FrameResult frame;
  for (frame.record.index = 0; frame.record.index < 4; frame.record.index += 2) writer.add(frame);
  EXPECT_THAT(error_when_opened(), HasSubstr("is damaged"));
}

TEST_F(Records, ARunSaysWhereItsSequenceWentAway) {
  RunResult run;
  for (int i = 0; i < 3; ++i) {
    FrameRecord record;
    record.index = i;
    record.status = i == 0 ? FrameStatus::tracked : FrameStatus::unreadable;
    run.records.push_back(record);
  }
  EXPECT_EQ(why_gone(sequence_.path(), run), "");
  EXPECT_EQ(why_gone("generated:room", run), "");
  EXPECT_THAT(why_gone(out_.path("gone"), run), HasSubstr("2 of 3 frames could not be read"));
  for (const std::size_t i : {1U, 2U})
    run.records.change(i, [](FrameRecord& record) { record.status = FrameStatus::tracked; });
  EXPECT_EQ(why_gone(out_.path("gone"), run), "");
}

TEST_F(Records, WithoutTheirSequenceTheRestStaysUsable) {
  fs::remove_all(sequence_.path());
  const OpenedRun opened = open_run(run_folder());
  EXPECT_THAT(opened.no_images, HasSubstr(sequence_.path()));
  EXPECT_EQ(opened.source->size(), kRecordedFrames);
  EXPECT_EQ(opened.source->ground_truth().size(), static_cast<std::size_t>(kRecordedFrames));
  const Frame frame = opened.source->read(2);
  EXPECT_FALSE(frame.readable());
  EXPECT_EQ(frame.problem, opened.no_images);
  EXPECT_EQ(frame.timestamp, run_.records[2].timestamp);
}

TEST_F(Records, AChangedSequenceIsNoticed) {
  const std::string before = sequence_fingerprint(*source_);
  cv::Mat image = cv::imread(sequence_.path(SmallSequence::colour(0)));
  cv::circle(image, {40, 40}, 9, {0, 0, 255}, cv::FILLED);
  sequence_.folder.write(SmallSequence::colour(0), image);
  EXPECT_NE(sequence_fingerprint(*open_sequence(sequence_.path())), before);
  EXPECT_THAT(open_run(run_folder()).no_images, HasSubstr("no longer, the sequence"));
  EXPECT_THAT(input_error_of([&] { (void)open_run(run_folder(), sequence_.path()); }),
              HasSubstr("no longer, the sequence"));
}

TEST_F(Records, OfARunThatWasKilledOpenWithTheFramesTheyHold) {
  const std::string whole = out_.read(records());
  // Magic and version, then the header's chunk: kind, three numbers of which the first is its length,
  // content.
  constexpr std::size_t kHead = 8 + 4 + 1 + 3 * 4;
  std::uint32_t header = 0;
  std::memcpy(&header, whole.data() + 8 + 4 + 1, sizeof(header));
  const std::size_t frames_at = kHead + header;
  std::size_t least = kRecordedFrames, most = 0;
  for (const double share : {0.2, 0.5, 0.8, 0.97}) {
    const auto kept = static_cast<std::size_t>(share * static_cast<double>(whole.size() - frames_at));
    out_.write(records(), whole.substr(0, frames_at + kept));
    const OpenedRun opened = open_run(run_folder());
    const RunResult& run = opened.recorded->run;
    ASSERT_FALSE(run.records.empty()) << share;
    least = std::min(least, run.records.size()), most = std::max(most, run.records.size());
    EXPECT_THAT(opened.recorded->cut_short,
                HasSubstr(fmt::format("is cut short after {} frames", run.records.size())));
    EXPECT_EQ(run.scores.size(), run.records.size());
    EXPECT_EQ(opened.recorded->record(run.records.size() - 1).features.size(),
              run_.records[run.records.size() - 1].features.size());
    EXPECT_TRUE(run.interrupted);
    EXPECT_EQ(opened.recorded->ground_truth.size(), source_->ground_truth().size());
    for (std::size_t i = 0; i < run.records.size(); ++i)
      EXPECT_EQ(run.records[i].inliers, run_.records[i].inliers) << i;
  }
  EXPECT_LT(least, most);
}

TEST_F(Records, OfAWholeFileAreOpenedWithoutReadingItsFrames) {
  const std::string whole = out_.read(records());
  // The last frame's chunk is none any more: that is told when it is looked at, and the others are there.
  std::string damaged = whole;
  const std::size_t at = tables_of(whole) - 8;
  damaged[at] = static_cast<char>(damaged[at] ^ 1);
  out_.write(records(), damaged);
  EXPECT_EQ(error_when_opened(), "");
  const OpenedRun opened = open_run(run_folder());
  EXPECT_EQ(opened.recorded->run.records.back().inliers, run_.records.back().inliers);
  EXPECT_EQ(opened.recorded->record(0).features.size(), run_.records[0].features.size());
  EXPECT_THAT(input_error_of([&] { (void)opened.recorded->record(kRecordedFrames - 1); }),
              HasSubstr(fmt::format("is damaged after {} frames", kRecordedFrames - 1)));
  EXPECT_THAT(input_error_of([&] { (void)opened.recorded->mask(kRecordedFrames - 1); }),
              HasSubstr("is damaged after"));
}

TEST_F(Records, OfTheVersionBeforeAreRead) {
  // It had neither tables nor a foot.
  const std::string whole = out_.read(records());
  const std::size_t tables = tables_of(whole);
  std::uint32_t table = 0;
  ASSERT_EQ(whole[tables], 'T');
  std::memcpy(&table, whole.data() + tables + 1, sizeof(table));
  const std::size_t end = tables + 1 + 3 * sizeof(table) + table;
  std::string old = whole.substr(0, tables) + whole.substr(end, whole.size() - end - kRecordsFootBytes);
  old[8] = kOldestRecordsVersion;
  out_.write(records(), old);
  const OpenedRun opened = open_run(run_folder());
  EXPECT_EQ(opened.recorded->cut_short, "");
  EXPECT_EQ(opened.recorded->hash, run_hash(run_.records));
  EXPECT_EQ(opened.recorded->run.points.size(), run_.points.size());
  EXPECT_EQ(opened.recorded->record(3).features.size(), run_.records[3].features.size());
  old[8] = kOldestRecordsVersion - 1;
  out_.write(records(), old);
  EXPECT_THAT(error_when_opened(), HasSubstr("is of version 7"));
}

TEST_F(Records, CutShortAmongWhatTheEndTellsOpenWithAllFrames) {
  const std::string whole = out_.read(records());
  for (const std::size_t kept : {std::size_t{tables_of(whole)}, std::size_t{tables_of(whole)} + 9,
                                 whole.size() - kRecordsFootBytes, whole.size() - 1}) {
    out_.write(records(), whole.substr(0, kept));
    EXPECT_THAT(error_when_opened(), HasSubstr(fmt::format("is cut short after {} frames", kRecordedFrames)));
  }
}

TEST_F(Records, BadFilesAreToldInOneSentence) {
  const std::string whole = out_.read(records());
  ASSERT_GT(whole.size(), 4000U);

  out_.truncate(records(), 0.6);
  EXPECT_THAT(error_when_opened(), HasSubstr("is cut short after"));
  out_.write(records(), std::string());
  EXPECT_THAT(error_when_opened(), HasSubstr("is no file of records"));
  out_.write(records(), std::string("something else altogether"));
  EXPECT_THAT(error_when_opened(), HasSubstr("is no file of records"));
  std::string other = whole;
  other[8] = 99;
  out_.write(records(), other);
  EXPECT_THAT(error_when_opened(), HasSubstr("is of version 99"));
  // Whatever byte is changed behind the version, it is noticed: those of frames once these are looked at.
  std::vector<std::size_t> places;
  for (std::size_t at = 12; at < whole.size(); at += whole.size() / 60) places.push_back(at);
  for (std::size_t at = whole.size() - kRecordsFootBytes; at < whole.size(); ++at) places.push_back(at);
  for (const std::size_t at : places) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    out_.write(records(), damaged);
    const std::string told = error_when_read();
    EXPECT_TRUE(told.find("is damaged") != std::string::npos ||
                told.find("is cut short") != std::string::npos)
        << at << ": " << told;
  }
  fs::remove(out_.path(records()));
  EXPECT_THAT(error_when_opened(), HasSubstr("has no records.bin"));
}

TEST(Fingerprints, DependOnContentAlone) {
  const SmallSequence one(4), same(4), longer(5);
  EXPECT_EQ(sequence_fingerprint(*open_sequence(one.path())),
            sequence_fingerprint(*open_sequence(same.path())));
  EXPECT_NE(sequence_fingerprint(*open_sequence(one.path())),
            sequence_fingerprint(*open_sequence(longer.path())));
}

}  // namespace
}  // namespace stillpoint
