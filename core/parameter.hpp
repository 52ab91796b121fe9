#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace stillpoint {

/// One constant of a run: where it lives, its range, unit and meaning. TOML files, `--set`, help and the
/// parameters panel are made from these.
struct Parameter {
  std::string key;                    ///< `section.name`, as in the TOML file
  std::vector<std::string> old_keys;  ///< still read, written no more
  std::variant<bool*, int*, double*, std::string*> value;
  double min = 0.0, max = 0.0;       ///< inclusive, numbers only
  std::vector<std::string> choices;  ///< strings only: the values allowed; empty: any text
  std::string unit;                  ///< "px", "m", "frames", "" for plain numbers
  std::string help;                  ///< one line
};

/// A numeric parameter and the values it is given.
struct SweepRange {
  std::string parameter;  ///< `section.name`
  double low = 0.0, high = 0.0;
  int steps = 7;  ///< values from low to high, both among them
  bool operator==(const SweepRange&) const = default;
};

/// What a section of constants lists itself into, a row a constant: its name, its place, its default, its
/// range, its unit and what it means, each written down once.
class ParameterTable {
 public:
  /// Gives each constant listed its default.
  ParameterTable() = default;
  /// Collects the constants listed under a section's name.
  ParameterTable(std::string section, std::vector<Parameter>& into)
      : section_(std::move(section)), into_(&into) {}

  ParameterTable& number(const char* name, int& value, int standard, double min, double max, const char* unit,
                         const char* help) {
    return add(name, value, standard, min, max, {}, unit, help);
  }
  ParameterTable& number(const char* name, double& value, double standard, double min, double max,
                         const char* unit, const char* help) {
    return add(name, value, standard, min, max, {}, unit, help);
  }
  ParameterTable& flag(const char* name, bool& value, bool standard, const char* help) {
    return add(name, value, standard, 0.0, 1.0, {}, "", help);
  }
  ParameterTable& choice(const char* name, std::string& value, const char* standard,
                         std::vector<std::string> choices, const char* help) {
    return add(name, value, std::string(standard), 0.0, 0.0, std::move(choices), "", help);
  }

  ParameterTable& text(const char* name, std::string& value, const char* help) {
    return add(name, value, std::string(), 0.0, 0.0, {}, "", help);
  }

  /// The constant listed last had another name before: files that use it are still read.
  void formerly(const char* name) {
    if (into_ != nullptr) into_->back().old_keys.push_back(section_ + "." + name);
  }

 private:
  template <typename Value>
  ParameterTable& add(const char* name, Value& value, Value standard, double min, double max,
                      std::vector<std::string> choices, const char* unit, const char* help) {
    if (into_ == nullptr)
      value = std::move(standard);
    else
      into_->push_back({section_ + "." + name, {}, &value, min, max, std::move(choices), unit, help});
    return *this;
  }

  std::string section_;
  std::vector<Parameter>* into_ = nullptr;  // null: defaults are given
};

/// For a section's constructor: every constant at the default its table names.
template <typename Section>
void set_defaults(Section& section) {
  ParameterTable defaults;
  section.list(defaults);
}

/// A section of constants whose type only its owner knows: a value, as the section itself. A section is a
/// struct with `static constexpr const char* kSection` (its TOML name), a constructor that calls
/// set_defaults, `list(ParameterTable&)` and `==`.
class AnySection {
 public:
  AnySection() = default;
  template <typename Section>
  explicit AnySection(Section section) : held_(std::make_unique<Held<Section>>(std::move(section))) {}
  AnySection(const AnySection& other) : held_(other.held_ ? other.held_->clone() : nullptr) {}
  AnySection(AnySection&&) noexcept = default;
  AnySection& operator=(AnySection other) noexcept {
    held_ = std::move(other.held_);
    return *this;
  }
  ~AnySection() = default;

  [[nodiscard]] bool empty() const { return held_ == nullptr; }
  [[nodiscard]] const char* name() const { return held_ ? held_->name() : ""; }
  void list(std::vector<Parameter>& into) {
    if (held_) held_->list(into);
  }
  /// Null where another type is held.
  template <typename Section>
  [[nodiscard]] Section* as() const {
    auto* held = dynamic_cast<Held<Section>*>(held_.get());
    return held == nullptr ? nullptr : &held->section;
  }
  [[nodiscard]] bool operator==(const AnySection& other) const {
    if (!held_ || !other.held_) return !held_ && !other.held_;
    return held_->equals(*other.held_);
  }

 private:
  struct Base {
    virtual ~Base() = default;
    [[nodiscard]] virtual std::unique_ptr<Base> clone() const = 0;
    [[nodiscard]] virtual const char* name() const = 0;
    [[nodiscard]] virtual bool equals(const Base& other) const = 0;
    virtual void list(std::vector<Parameter>& into) = 0;
  };
  template <typename Section>
  struct Held final : Base {
    explicit Held(Section s) : section(std::move(s)) {}
    [[nodiscard]] std::unique_ptr<Base> clone() const override { return std::make_unique<Held>(section); }
    [[nodiscard]] const char* name() const override { return Section::kSection; }
    [[nodiscard]] bool equals(const Base& other) const override {
      const auto* same = dynamic_cast<const Held*>(&other);
      return same != nullptr && same->section == section;
    }
    void list(std::vector<Parameter>& into) override {
      ParameterTable table(Section::kSection, into);
      section.list(table);
    }
    Section section;
  };
  std::unique_ptr<Base> held_;
};

}  // namespace stillpoint
