#include "frame/check.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <stdexcept>

namespace eigenlight::detail {

void throw_invalid(std::string_view format, std::initializer_list<MessageValue> values) {
  using Kind = MessageValue::Kind;
  fmt::dynamic_format_arg_store<fmt::format_context> store;
  for (const MessageValue& value : values) {
    switch (value.kind) {
      case Kind::kSigned:
        store.push_back(value.whole);
        break;
      case Kind::kUnsigned:
        store.push_back(value.natural);
        break;
      case Kind::kFloat:
        store.push_back(value.single);
        break;
      case Kind::kDouble:
        store.push_back(value.real);
        break;
      case Kind::kText:
        store.push_back(value.text);
        break;
    }
  }
  throw std::invalid_argument(fmt::vformat(fmt::string_view(format.data(), format.size()), store));
}

}  // namespace eigenlight::detail
