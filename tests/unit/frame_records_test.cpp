#include "core/run/frame_records.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/replayable_run.hpp"
#include "core/odometry/smoother.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint::testing {
namespace {

Pose some_pose(int i) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0.1 * i, 1.0 / (i + 1), -std::sqrt(i));
  pose.linear() = Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  return pose;
}

/// A record none of whose fields is as a fresh one has it.
FrameRecord full_record(int i) {
  FrameRecord r;
  r.index = i, r.timestamp = 1000.0 + i / 30.0, r.status = FrameStatus::relocalised;
  r.note = "a note that is too long to be held in the string itself";
  r.world_from_camera = some_pose(i), r.camera_from_reference = some_pose(i + 1);
  r.estimated = true, r.reference_keyframe = i / 7, r.pose_start = PoseStart::epnp;
  r.measured = {.mask = i % 2 == 0, .rounds = false, .solving = i % 3 == 0, .times = false};
  r.features_found = 1000 + i, r.features_removed = 20, r.features_kept = 980 + i, r.mask_share = 0.01 * i;
  r.mask_problem = "no mask", r.motion_rounds = 2;
  r.motion_figures = {{"one_figure_of_the_method", 0.1 * i}, {"another", std::nan("")}};
  r.matches = 300, r.inliers = 250, r.rms_px = 0.7, r.refine_iterations = 5;
  for (int k = 0; k < 36; ++k) r.pose_covariance(k / 6, k % 6) = 1e-6 * (k + i);
  r.keyframe = true, r.new_points = 1, r.fused_points = 2, r.culled_points = 3, r.culled_keyframes = 4;
  r.map_points = 5, r.map_keyframes = 6, r.bundle_rms_before_px = 0.9, r.bundle_rms_px = 0.8;
  r.bundle_iterations = 7;
  r.prior_pose = some_pose(2), r.motion_pose = some_pose(3);
  r.removal_check = {some_pose(4), 0.002, some_pose(5)};
  r.direct.reference_frame = i, r.direct.believed = true, r.direct.patches = 9, r.direct.share = 0.25;
  r.direct.seen = std::make_shared<const std::vector<DirectPatch>>(2, DirectPatch{{1.0F, 2.0F}, 3.0F, 0.5F});
  r.ms = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  r.features = {{{3.0F, 4.0F}, 1.5F, 0.2F, 17, 3, FeatureFate::outlier, 0.25F}};
  return r;
}

void expect_same(const FrameRecord& a, const FrameRecord& b) {
  EXPECT_TRUE(computed_alike(a, b));
  EXPECT_EQ(a.note, b.note);
  EXPECT_EQ(a.mask_problem, b.mask_problem);
  EXPECT_EQ(a.camera_from_reference.matrix(), b.camera_from_reference.matrix());
  EXPECT_EQ(a.pose_covariance, b.pose_covariance) << "both halves, for they need not agree to the last bit";
  for (const auto part :
       {&RecordParts::mask, &RecordParts::rounds, &RecordParts::features, &RecordParts::matches,
        &RecordParts::solving, &RecordParts::direct, &RecordParts::keyframes, &RecordParts::culled_keyframes,
        &RecordParts::points, &RecordParts::fused_points, &RecordParts::bundle, &RecordParts::times})
    EXPECT_EQ(a.measured.*part, b.measured.*part);
  for (const auto ms :
       {&StageTimes::motion, &StageTimes::features, &StageTimes::matching, &StageTimes::pose,
        &StageTimes::mapping, &StageTimes::bundle, &StageTimes::total, &StageTimes::epnp,
        &StageTimes::consensus, &StageTimes::refine, &StageTimes::direct, &StageTimes::stereo})
    EXPECT_EQ(a.ms.*ms, b.ms.*ms);
  ASSERT_TRUE(a.prior_pose && a.motion_pose && a.removal_check.truth_removed);
  EXPECT_EQ(a.prior_pose->matrix(), b.prior_pose->matrix());
  EXPECT_EQ(a.motion_pose->matrix(), b.motion_pose->matrix());
  EXPECT_EQ(a.removal_check.truth_removed->matrix(), b.removal_check.truth_removed->matrix());
  ASSERT_EQ(a.motion_figures.size(), b.motion_figures.size());
  EXPECT_EQ(a.motion_figures[0].value, b.motion_figures[0].value);
  ASSERT_TRUE(a.direct.seen);
  EXPECT_EQ(a.direct.seen->size(), b.direct.seen->size());
  ASSERT_EQ(a.features.size(), b.features.size());
  EXPECT_EQ(a.features[0].static_weight, b.features[0].static_weight);
}

TEST(FrameRecords, ThatArePutByComeBackToTheLastBit) {
  FrameRecords records = records_put_by(ByteStore::make());
  constexpr int kMany = 3 * static_cast<int>(FrameRecords::kChunk) + 5;
  for (int i = 0; i < kMany; ++i) records.push_back(full_record(i));
  ASSERT_EQ(records.size(), static_cast<std::size_t>(kMany));
  int walked = 0;
  for (const FrameRecord& record : records) expect_same(record, full_record(walked++));
  EXPECT_EQ(walked, kMany);
  for (const int i : {kMany - 1, 0, 130, 64, 63})
    expect_same(records[static_cast<std::size_t>(i)], full_record(i));
  EXPECT_THROW((void)records.at(static_cast<std::size_t>(kMany)), std::out_of_range);
  const std::vector<double> features = frame_figure_values({records}, frame_figure("features"));
  EXPECT_EQ(features.back(), 1000.0 + kMany - 1);
}

TEST(FrameRecords, ThatArePutByTakeNoMemory) {
  const auto store = ByteStore::make();
  FrameRecords records = records_put_by(store);
  ScoreList scores = scores_put_by(store);
  constexpr std::size_t kMany = 6400;
  std::size_t half = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    records.push_back(full_record(static_cast<int>(i)));
    FrameScores scored;
    scored.known = true, scored.dynamic_inliers = static_cast<int>(i);
    scores.push_back(scored);
    if (i + 1 == kMany / 2) half = records.held_bytes() + scores.held_bytes();
  }
  const std::size_t grown = records.held_bytes() + scores.held_bytes() - half;
  EXPECT_LT(static_cast<double>(grown) / (kMany / 2.0), 8.0) << "bytes a frame";
  EXPECT_EQ(scores[17].dynamic_inliers, 17);
  std::size_t row = 0;
  for (const FrameScores& one : scores) EXPECT_EQ(one.dynamic_inliers, static_cast<int>(row++));
}

TEST(FrameRecords, CopiesShareWhatIsFull) {
  FrameRecords records;
  for (int i = 0; i < 6400; ++i) records.push_back(full_record(i));
  const std::size_t all = records.held_bytes();
  const FrameRecords copy = records;
  EXPECT_EQ(&*copy.begin(), &*records.begin()) << "not a copy of the frame";
  records.push_back(full_record(6400));
  EXPECT_EQ(copy.size(), 6400U);
  EXPECT_GT(all, 6400 * sizeof(FrameRecord));
}

TEST(FrameRecords, WhatIsEditedIsTheListsOwn) {
  for (const bool put_by : {false, true}) {
    FrameRecords records = put_by ? records_put_by(ByteStore::make()) : FrameRecords();
    for (int i = 0; i < 200; ++i) records.push_back(full_record(i));
    const FrameRecords before = records;
    for (const std::size_t i : {std::size_t{3}, std::size_t{199}})
      records.change(i, [](FrameRecord& record) { record.inliers = 1; });
    EXPECT_EQ(records[3].inliers, 1);
    EXPECT_EQ(records[199].inliers, 1);
    EXPECT_EQ(before[3].inliers, 250);
    EXPECT_EQ(before[199].inliers, 250);
    FrameRecords some = records.first(130);
    EXPECT_EQ(some.size(), 130U);
    some.push_back(full_record(7));
    EXPECT_EQ(some[130].index, 7);
    EXPECT_EQ(records[130].index, 130);
    records.resize(10);
    EXPECT_EQ(records.back().index, 9);
    EXPECT_EQ(before.size(), 200U);
  }
}

TEST(FrameRecords, AreReadFromSeveralThreads) {
  FrameRecords records = records_put_by(ByteStore::make());
  for (int i = 0; i < 1000; ++i) records.push_back(full_record(i));
  std::vector<std::jthread> readers;
  std::vector<long> sums(3, 0);
  for (long& sum : sums)
    readers.emplace_back([&records, &sum] {
      for (const FrameRecord& record : records) sum += record.index;
    });
  readers.clear();
  EXPECT_THAT(sums, ::testing::Each(1000L * 999 / 2));
}

TEST(FrameRecords, IteratorsSearchAsThoseOfAVectorDo) {
  FrameRecords records = records_put_by(ByteStore::make());
  for (int i = 0; i < 300; ++i) records.push_back(full_record(i));
  const auto at = std::lower_bound(records.begin(), records.end(), 177,
                                   [](const FrameRecord& one, int index) { return one.index < index; });
  ASSERT_NE(at, records.end());
  EXPECT_EQ(at->index, 177);
  EXPECT_EQ(at - records.begin(), 177);
  EXPECT_EQ(std::count_if(records.begin(), records.end(), [](const auto& one) { return one.index >= 250; }),
            50);
}

void expect_outlined(const FrameOutline& outline, const FrameRecord& record) {
  EXPECT_EQ(outline.index, record.index);
  EXPECT_EQ(outline.timestamp, record.timestamp);
  EXPECT_EQ(outline.status, record.status);
  EXPECT_EQ(outline.estimated, record.estimated);
  EXPECT_EQ(outline.keyframe, record.keyframe);
  EXPECT_EQ(outline.remarked, !remarks_on(record).empty());
  EXPECT_EQ(outline.removal_checked, record.removal_check.nothing_removed.has_value());
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ(outline.position[static_cast<std::size_t>(axis)], record.world_from_camera.translation()[axis]);
}

/// Frames of several kinds.
FrameRecord mixed_record(int i) {
  FrameRecord record = full_record(i);
  if (i % 3 == 0) record.note.clear();
  if (i % 6 == 0) record.mask_problem.clear();
  if (i % 5 == 0) record.status = FrameStatus::lost, record.estimated = record.keyframe = false;
  if (i % 4 == 0) record.removal_check = {};
  return record;
}

TEST(FrameRecords, OutlinesTellWhatRecordsDo) {
  const auto store = ByteStore::make();
  for (FrameRecords records :
       {FrameRecords(), records_put_by(store), records_put_by(store, Outlines::at_hand)}) {
    for (int i = 0; i < 200; ++i) records.push_back(mixed_record(i));
    records.change(3, [](FrameRecord& record) { record.keyframe = !record.keyframe; });
    EXPECT_NE(records[3].keyframe, mixed_record(3).keyframe);
    FrameRecords some = records.first(150);
    some.resize(151);
    records.change(199, [](FrameRecord& record) { record.index = 1000; });
    for (const FrameRecords& all : {records, some}) {
      const FrameOutlines& outlines = all.outlines();
      ASSERT_EQ(outlines.size(), all.size());
      std::size_t row = 0;
      for (const FrameRecord& record : all) expect_outlined(outlines[row++], record);
    }
    EXPECT_EQ(records.outlines().back().index, 1000);
  }
}

TEST(FrameRecords, OutlinesAtHandTakeLittle) {
  FrameRecords records = records_put_by(ByteStore::make(), Outlines::at_hand);
  constexpr int kMany = 6400;
  for (int i = 0; i < kMany; ++i) records.push_back(mixed_record(i));
  EXPECT_LT(static_cast<double>(records.held_bytes()) / kMany, 90.0) << "bytes a frame";
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// A run whose frames, errors and scores are of several kinds.
struct MixedRun {
  FrameRecords records = records_put_by(ByteStore::make());
  ScoreList scores;
  TrajectoryEvaluation evaluation;

  void add(int frames) {
    for (const int end = static_cast<int>(records.size()) + frames; static_cast<int>(records.size()) < end;) {
      const int i = static_cast<int>(records.size());
      const FrameRecord record = mixed_record(i);
      FrameScores scored;
      scored.known = i % 2 == 0, scored.dynamic_inliers = i, scored.mask.found_rightly = 1 + i;
      scores.push_back(scored);
      evaluation.matched.push_back({record.timestamp, record.timestamp, some_pose(i), some_pose(i + 2)});
      evaluation.ate.errors.push_back({record.timestamp, 0.01 * i, 0.0});
      evaluation.rpe_frame.errors.push_back({0.0, record.timestamp, 0.02 * i, 0.03 * i});
      if (i % 7 != 0) evaluation.rpe_time.errors.push_back({0.0, record.timestamp, 0.04 * i, 0.05 * i});
      records.push_back(record);
    }
  }
};

TEST(FigureColumns, AreThoseOfAWalkHoweverTheRunGrew) {
  MixedRun run;
  FigureColumns columns;
  const int inliers = frame_figure("inliers"), few = 30;
  const auto count = static_cast<int>(frame_figure_infos().size());
  for (const int more : {few, 1, 100, 0, 64}) {
    run.add(more);
    const MeasuredFrames measured{run.records, &run.evaluation, &run.scores, &columns};
    std::vector<std::vector<double>> walked(static_cast<std::size_t>(count));
    walk_figures(measured, [&](const FrameRecord&, const std::vector<double>& all) {
      for (std::size_t i = 0; i < all.size(); ++i) walked[i].push_back(all[i]);
    });
    int known = 0;
    for (int figure = 0; figure < count; ++figure) {
      // Some are asked for late, as when somebody chooses another lane.
      if (more == few && figure % 2 == 0 && figure != inliers) continue;
      const std::vector<double>& all = walked[static_cast<std::size_t>(figure)];
      EXPECT_TRUE(same(frame_figure_values(measured, figure), all))
          << shown_name(frame_figure_infos()[static_cast<std::size_t>(figure)]);
      EXPECT_TRUE(same(frame_figure_values({run.records, &run.evaluation, &run.scores}, figure), all));
      known += std::any_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); }) ? 1 : 0;
    }
    EXPECT_GT(known, 20) << "more than what is never known is compared";
  }
  // What was shown of the run when it was shorter.
  const FrameRecords first = run.records.first(few);
  EXPECT_EQ(frame_figure_values({first, nullptr, &run.scores, &columns}, inliers).size(),
            static_cast<std::size_t>(few));
}

TEST(FigureColumns, OnlyNewFramesAreWalkedOver) {
  // Records that change behind its back show what was asked of them.
  FrameRecords records;
  for (int i = 0; i < 10; ++i) records.push_back(full_record(i));
  FigureColumns columns;
  const int inliers = frame_figure("inliers");
  EXPECT_EQ(frame_figure_values({records, nullptr, nullptr, &columns}, inliers)[4], 250.0);
  records.change(4, [](FrameRecord& record) { record.inliers = 1; });
  records.push_back(full_record(10));
  const std::vector<double> values = frame_figure_values({records, nullptr, nullptr, &columns}, inliers);
  EXPECT_EQ(values[4], 250.0);
  EXPECT_EQ(values.size(), 11U);
}

TEST(TrackedPoses, ArePutByToTheLastBit) {
  TrackedPoses poses = poses_put_by(ByteStore::make());
  for (int i = 0; i < 640; ++i) add_pose(mixed_record(i), poses);
  EXPECT_EQ(poses.size(), 512U) << "a fifth has none";
  EXPECT_EQ(poses[0].frame, 1);
  const TrackedPose last = poses[511];
  EXPECT_EQ(last.frame, 639);
  EXPECT_EQ(last.timestamp, full_record(639).timestamp);
  EXPECT_EQ(last.reference_keyframe, full_record(639).reference_keyframe);
  const Eigen::Matrix<double, 3, 4> pose =
      Eigen::Map<const Eigen::Matrix<double, 3, 4>>(last.camera_from_reference.data());
  EXPECT_EQ(pose, some_pose(640).matrix().topRows<3>());
  EXPECT_LT(poses.held_bytes(), 512U * 40U);
}

TEST(RevisedPoses, TakeAPoseAFrameAndShareIt) {
  RevisedPoses poses;
  constexpr int kMany = 6400;
  for (int i = 0; i < kMany; ++i) poses.add(3 * i, {i, some_pose(i)});
  EXPECT_LT(static_cast<double>(poses.held_bytes()) / kMany, 112.0) << "bytes a frame";
  RevisedPoses copy = poses;
  copy.add(3 * kMany, {1, some_pose(1)});
  EXPECT_EQ(poses.size(), static_cast<std::size_t>(kMany));
  const auto found = copy.of(300);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->reference_keyframe, 100);
  EXPECT_EQ(found->camera_from_reference.matrix(), some_pose(100).matrix());
  EXPECT_FALSE(copy.of(301));
  EXPECT_FALSE(RevisedPoses().of(0));
}

TEST(ReplayableRun, ShowsOfAFrameThatIsPutByWhatWasRecorded) {
  constexpr int kFrames = 200, kChunk = static_cast<int>(FrameRecords::kChunk);
  const auto source = rendered("room", kFrames);
  Config config;
  config.features.count = 150;
  ReplayableRun run(*source, config);
  const auto read = [&source](int index) { return source->read(index); };
  std::vector<FrameRecord> recorded;
  std::size_t held = 0;
  for (int i = 0; i < kFrames; ++i) {
    recorded.push_back(run.process_next(read).record);
    if (i + 1 == kChunk) held = run.held_bytes();
  }
  EXPECT_LT(static_cast<double>(run.held_bytes() - held) / (kFrames - kChunk), 250.0) << "bytes a frame";
  for (const int i : {0, 5, 63, 64, 130, 199}) {
    const FrameRecord again = run.record(i), &before = recorded[static_cast<std::size_t>(i)];
    EXPECT_TRUE(computed_alike(again, before)) << i;
    EXPECT_EQ(again.ms.total, before.ms.total);
    EXPECT_EQ(again.note, before.note);
    EXPECT_EQ(again.pose_covariance, before.pose_covariance);
  }
  EXPECT_EQ(run.hash(), run_hash(FrameRecords(recorded)));
  const RunView view = run.view();
  std::size_t row = 0;
  for (const FrameRecord& record : view.records) {
    EXPECT_TRUE(computed_alike(record,
                               [&] {
                                 FrameRecord without = recorded[row];
                                 without.features.clear();
                                 return without;
                               }()))
        << row;
    ++row;
  }
  EXPECT_EQ(row, static_cast<std::size_t>(kFrames));
  const Trajectory by_records = [&] {
    RunOptions options;
    options.count = kFrames;
    return run_sequence(*source, config, options).trajectory;
  }();
  ASSERT_EQ(view.trajectory.size(), by_records.size());
  for (std::size_t i = 0; i < by_records.size(); ++i)
    EXPECT_EQ(view.trajectory[i].world_from_camera.matrix(), by_records[i].world_from_camera.matrix());
}

TEST(FrameRecords, OfARunArePutBy) {
  constexpr int kFrames = 68;  // more than a chunk
  const auto source = rendered("room", kFrames);
  Config config;
  config.features.count = 200;
  const RunResult run = run_sequence(*source, config);
  ASSERT_EQ(run.records.size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(run.records.held_bytes(), kFrames * sizeof(FrameRecord)) << "no more than a chunk at a time";
  EXPECT_LT(run.scores.held_bytes(), kFrames * sizeof(FrameScores));
}

}  // namespace
}  // namespace stillpoint::testing
