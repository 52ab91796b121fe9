#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace stillpoint {

class StoredBytes;

/// Puts the chunks of a ChunkedList by, so that they take no memory, and has them again.
template <typename T>
class ChunkKeeper {
 public:
  using Chunk = std::vector<T>;
  /// A chunk that is put by.
  struct Kept {
    std::shared_ptr<const StoredBytes> bytes{};
    std::weak_ptr<const Chunk> lately{};  // the keeper's own, from one thread at a time
  };

  ChunkKeeper() = default;
  ChunkKeeper(const ChunkKeeper&) = delete;
  ChunkKeeper& operator=(const ChunkKeeper&) = delete;
  virtual ~ChunkKeeper() = default;

  [[nodiscard]] virtual Kept put(const Chunk& chunk) = 0;
  /// From any thread. @throws InputError when the disk does not give it back
  [[nodiscard]] virtual std::shared_ptr<const Chunk> get(Kept& kept) = 0;
  /// What it takes after all, where there was no room elsewhere.
  [[nodiscard]] virtual std::size_t bytes_in_memory(const Kept& kept) const = 0;
};

/// A list that grows at its end, in chunks that do not change once they are full, so that copies share them:
/// a copy costs a pointer a chunk, however long the list is. With a keeper, full chunks are put by and take
/// no memory at all.
///
/// A value. What one copy adds or edits the others do not see. Elements are had as values, or walked over.
template <typename T>
class ChunkedList {
 public:
  using value_type = T;
  using Chunk = std::vector<T>;
  static constexpr std::size_t kChunk = 64;  // elements

  ChunkedList() = default;
  explicit ChunkedList(std::shared_ptr<ChunkKeeper<T>> keeper) : keeper_(std::move(keeper)) {}
  /// Those at hand, which stay in memory.
  ChunkedList(std::vector<T> all) {  // NOLINT(google-explicit-constructor)
    for (T& one : all) push_back(std::move(one));
  }

  void push_back(T one) {
    last_.push_back(std::move(one));
    if (last_.size() < kChunk) return;
    auto full = std::make_shared<Full>();
    if (keeper_)
      full->kept = keeper_->put(last_);
    else
      full->here = std::make_shared<Chunk>(std::move(last_));
    full_.push_back(std::move(full));
    last_.clear();
  }

  [[nodiscard]] std::size_t size() const { return full_.size() * kChunk + last_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }

  // Values, constant so that nobody takes one for the list's own.
  [[nodiscard]] const T operator[](std::size_t i) const {  // NOLINT(readability-const-return-type)
    if (i >= full_.size() * kChunk) return last_[i - full_.size() * kChunk];
    return (*chunk(i / kChunk))[i % kChunk];
  }
  [[nodiscard]] const T at(std::size_t i) const {  // NOLINT(readability-const-return-type)
    if (i >= size()) throw std::out_of_range("ChunkedList::at");
    return (*this)[i];
  }
  [[nodiscard]] const T front() const { return (*this)[0]; }          // NOLINT(readability-const-return-type)
  [[nodiscard]] const T back() const { return (*this)[size() - 1]; }  // NOLINT(readability-const-return-type)

  /// An element to be changed: its chunk becomes this list's own, and stays in memory.
  [[nodiscard]] T& edit(std::size_t i) {
    if (i >= full_.size() * kChunk) return last_[i - full_.size() * kChunk];
    std::shared_ptr<Full>& full = full_[i / kChunk];
    if (!full->here || full.use_count() > 1) {
      auto own = std::make_shared<Full>();
      own->here = std::make_shared<Chunk>(*chunk(i / kChunk));
      full = std::move(own);
    }
    return (*full->here)[i % kChunk];
  }

  /// The first of them, as a list that shares its chunks with this one.
  [[nodiscard]] ChunkedList first(std::size_t count) const {
    ChunkedList some(keeper_);
    const std::size_t chunks = std::min(count / kChunk, full_.size());
    some.full_.assign(full_.begin(), full_.begin() + static_cast<std::ptrdiff_t>(chunks));
    for (std::size_t i = chunks * kChunk; i < std::min(count, size()); ++i) some.last_.push_back((*this)[i]);
    return some;
  }
  void resize(std::size_t count) {
    if (count < size()) *this = first(count);
    while (size() < count) push_back(T());
  }

  /// Walks over them. What it refers to stays where it is as long as the walk stays in the same chunk; in a
  /// list without a keeper, as long as the list does.
  class const_iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    const_iterator() = default;
    const_iterator(const ChunkedList* list, std::size_t at) : list_(list), at_(at) {}

    reference operator*() const {
      const std::size_t in = at_ / kChunk;
      if (in >= list_->full_.size()) return list_->last_[at_ % kChunk];
      if (!chunk_ || in_ != in) chunk_ = list_->chunk(in), in_ = in;
      return (*chunk_)[at_ % kChunk];
    }
    pointer operator->() const { return &**this; }
    value_type operator[](difference_type by) const { return *(*this + by); }
    const_iterator& operator+=(difference_type by) {
      at_ = static_cast<std::size_t>(static_cast<difference_type>(at_) + by);
      return *this;
    }
    const_iterator& operator-=(difference_type by) { return *this += -by; }
    const_iterator& operator++() { return *this += 1; }
    const_iterator& operator--() { return *this += -1; }
    const_iterator operator++(int) { return std::exchange(*this, *this + 1); }
    const_iterator operator--(int) { return std::exchange(*this, *this - 1); }
    friend const_iterator operator+(const_iterator it, difference_type by) { return it += by; }
    friend const_iterator operator+(difference_type by, const_iterator it) { return it += by; }
    friend const_iterator operator-(const_iterator it, difference_type by) { return it -= by; }
    friend difference_type operator-(const const_iterator& a, const const_iterator& b) {
      return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
    }
    friend bool operator==(const const_iterator& a, const const_iterator& b) { return a.at_ == b.at_; }
    friend auto operator<=>(const const_iterator& a, const const_iterator& b) { return a.at_ <=> b.at_; }

   private:
    const ChunkedList* list_ = nullptr;
    std::size_t at_ = 0;
    mutable std::shared_ptr<const Chunk> chunk_{};  // walked last, …
    mutable std::size_t in_ = 0;                    // … and which it is
  };
  using iterator = const_iterator;
  [[nodiscard]] const_iterator begin() const { return {this, 0}; }
  [[nodiscard]] const_iterator end() const { return {this, size()}; }

  /// Bytes of memory it holds, chunks that it shares with copies included; what elements hold on the heap is
  /// left out.
  [[nodiscard]] std::size_t held_bytes() const {
    std::size_t bytes = sizeof(*this) + full_.capacity() * sizeof(full_[0]) + last_.capacity() * sizeof(T);
    for (const auto& full : full_) {
      bytes += sizeof(Full);
      if (full->kept.bytes) bytes += keeper_->bytes_in_memory(full->kept);
      if (full->here) bytes += sizeof(Chunk) + full->here->capacity() * sizeof(T);
    }
    return bytes;
  }

 private:
  struct Full {
    std::shared_ptr<Chunk> here{};  // null where it is put by
    typename ChunkKeeper<T>::Kept kept{};
  };
  [[nodiscard]] std::shared_ptr<const Chunk> chunk(std::size_t at) const {
    Full& full = *full_[at];
    return full.here ? std::shared_ptr<const Chunk>(full.here) : keeper_->get(full.kept);
  }

  std::shared_ptr<ChunkKeeper<T>> keeper_;
  std::vector<std::shared_ptr<Full>> full_;
  Chunk last_;  // not full yet
};

}  // namespace stillpoint
