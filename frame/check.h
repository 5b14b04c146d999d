// Checks of inputs. They are always on, and their message says what was expected.
#pragma once

#include <cassert>
#include <concepts>
#include <initializer_list>
#include <string_view>

namespace eigenlight::detail {

/// A value to be put into a message.
struct MessageValue {
  enum class Kind { kSigned, kUnsigned, kFloat, kDouble, kText };

  template <std::signed_integral T>
  MessageValue(T value) : kind(Kind::kSigned), whole(value) {}
  template <std::unsigned_integral T>
  MessageValue(T value) : kind(Kind::kUnsigned), natural(value) {}
  MessageValue(float value) : kind(Kind::kFloat), single(value) {}
  MessageValue(double value) : kind(Kind::kDouble), real(value) {}
  template <std::convertible_to<std::string_view> T>
  MessageValue(const T& value) : kind(Kind::kText), text(value) {}

  Kind kind;
  union {
    long long whole;
    unsigned long long natural;
    float single;
    double real;
    std::string_view text;
  };
};

/// Throws std::invalid_argument with `format`, in the syntax of fmt, filled in.
[[noreturn]] void throw_invalid(std::string_view format,
                                std::initializer_list<MessageValue> values);

}  // namespace eigenlight::detail

/// Throws std::invalid_argument with the formatted message unless `condition` holds.
#define EL_CHECK(condition, format, ...)                                          \
  do {                                                                            \
    if (!(condition)) ::eigenlight::detail::throw_invalid(format, {__VA_ARGS__}); \
  } while (false)

/// Checked in debug builds only: for pixel loops, whose inputs were checked before.
#define EL_DCHECK(condition) assert(condition)
