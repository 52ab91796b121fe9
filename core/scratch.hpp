#pragma once

namespace stillpoint {

/// Memory that an object keeps from call to call so as not to ask for it anew each time. It is no part of the
/// object's value: a copy begins without, so that copies share nothing and carry nothing they need not.
template <typename T>
class Scratch {
 public:
  Scratch() = default;
  Scratch(const Scratch&) {}
  Scratch(Scratch&&) noexcept = default;
  Scratch& operator=(const Scratch&) { return *this; }
  Scratch& operator=(Scratch&&) noexcept = default;
  ~Scratch() = default;

  [[nodiscard]] T& operator*() { return value_; }
  [[nodiscard]] T* operator->() { return &value_; }

 private:
  T value_{};
};

}  // namespace stillpoint
