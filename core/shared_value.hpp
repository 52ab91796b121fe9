#pragma once

#include <memory>
#include <utility>

namespace stillpoint {

/// A value that does not change, and that its copies share however large it is. Never null: a fresh one is as
/// a fresh T is.
template <typename T>
class SharedValue {
 public:
  SharedValue() : value_(fresh()) {}
  SharedValue(T value)  // NOLINT(google-explicit-constructor)
      : value_(std::make_shared<const T>(std::move(value))) {}
  /// @param value not null
  SharedValue(std::shared_ptr<const T> value)
      : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] const T& operator*() const { return *value_; }
  [[nodiscard]] const T* operator->() const { return value_.get(); }

 private:
  static const std::shared_ptr<const T>& fresh() {
    static const auto value = std::make_shared<const T>();
    return value;
  }
  std::shared_ptr<const T> value_;
};

}  // namespace stillpoint
