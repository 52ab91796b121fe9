#include "ui/session/export_job.hpp"

#include <chrono>
#include <exception>
#include <utility>

namespace stillpoint {
namespace {

constexpr auto kNewsEvery = std::chrono::milliseconds(100);  // so often that a bar moves evenly

}  // namespace

ExportJob::ExportJob(std::string folder, Work work, std::function<void()> on_news)
    : on_news_(std::move(on_news)), view_{.folder = std::move(folder), .what = {}, .done = 0, .total = 0} {
  thread_ = std::jthread([this, work = std::move(work)] { run(work); });
}

ExportJob::~ExportJob() { stop(); }

void ExportJob::run(const Work& work) {
  using Clock = std::chrono::steady_clock;
  auto told = Clock::now() - kNewsEvery;
  Outcome outcome;
  try {
    outcome.told = work({.progress =
                             [&](const char* what, int done, int total) {
                               tell(what, done, total);
                               if (Clock::now() - told < kNewsEvery) return;
                               told = Clock::now();
                               on_news_();
                             },
                         .stop = &stop_});
  } catch (const std::exception& error) {
    outcome = {error.what(), true};
  }
  {
    const std::lock_guard lock(mutex_);
    outcome_ = std::move(outcome);
  }
  on_news_();
}

void ExportJob::tell(const char* what, int done, int total) {
  const std::lock_guard lock(mutex_);
  view_.what = what;
  view_.done = done;
  view_.total = total;
}

std::optional<ExportView> ExportJob::view() const {
  const std::lock_guard lock(mutex_);
  return outcome_ ? std::nullopt : std::optional(view_);
}

std::optional<ExportJob::Outcome> ExportJob::outcome() const {
  const std::lock_guard lock(mutex_);
  return outcome_;
}

}  // namespace stillpoint
