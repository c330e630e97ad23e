#include <limits>

#include "protocol/option_files/option_texts.h"

namespace surfcast::protocol {
namespace {

constexpr std::string_view kTypescriptHead = R"(// Made by option_files from the table in protocol/picture_fields.cpp.
import type { MessageInitShape } from '@bufbuild/protobuf';
import type { Rgb } from '../state/rgb';
import * as plain from '../state/plain_values';
import type { DrawPictureSchema } from './surfcast_pb';

)";

/// "splat_convention" is splatConvention.
std::string camel_case(std::string_view name) {
  std::string result;
  for (size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '_' && i + 1 < name.size()) {
      result += static_cast<char>(name[++i] - 'a' + 'A');
    } else {
      result += name[i];
    }
  }
  return result;
}

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text) + "'";
}

/// Without a value in links that do not state it.
bool may_be_undefined(const PictureField& field) {
  return field.value.viewer_default->empty();
}

std::string type_of(const PictureField& field) {
  const std::string without = may_be_undefined(field) ? " | undefined" : "";
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return "Choice<" + in_quotes(camel_case(field.name)) + ">" + without;
    case FieldKind::kSwitch:
      return "boolean" + without;
    case FieldKind::kColor:
      return "Rgb" + without;
    default:
      return "number" + without;
  }
}

std::string default_of(const PictureField& field) {
  std::string text(*field.value.viewer_default);
  if (text.empty()) return "undefined";
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return in_quotes(text);
    case FieldKind::kSwitch:
      return text == "on" ? "true" : "false";
    case FieldKind::kColor:
      return "plain.colorIn(" + in_quotes(text) + ")!";
    default:
      return text;
  }
}

std::string bound(double number) {
  return number == std::numeric_limits<double>::infinity() ? "Infinity" : number_text(number);
}

/// The value of a text in a link, or undefined.
std::string reading(const PictureField& field) {
  const std::string text = "values.get(" + in_quotes(field.name) + ")";
  const NumberRange& range = field.value.range;
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return "plain.choiceIn(choices." + camel_case(field.name) + ", " + text + ")";
    case FieldKind::kSwitch:
      return "plain.switchIn(" + text + ")";
    case FieldKind::kColor:
      return "plain.colorIn(" + text + ")";
    default:
      return "plain.numberIn(" + text + ", " + bound(range.least) + ", " + bound(range.most) + ", " +
             (range.above ? "true" : "false") + ")";
  }
}

/// The text of a value in a link.
std::string writing(const PictureField& field) {
  const std::string value = camel_case(field.name);
  return "plain.textUnless(options." + value + ", defaultPlain." + value + ")";
}

/// The member of a message.
std::string message_member(const PictureField& field) {
  const std::string value = "options." + camel_case(field.name);
  const std::string stated =
      field.value.kind == FieldKind::kChoice ? "choices." + camel_case(field.name) + ".indexOf(" + value + ")" : value;
  std::string member = camel_case(field.value.place) + ": " + stated;
  if (!field.value.may_be_absent) return member;
  return "...(" + value + " === " + default_of(field) + " ? {} : { " + member + " })";
}

/// One line for each plain option of the viewer's links.
template <typename Line>
std::string lines(Line line) {
  std::string text;
  for (const PictureField& field : picture_fields()) {
    if (field.value.viewer_default) text.append(line(field)).append("\n");
  }
  return text;
}

std::string choices() {
  std::string text =
      "/** The names of choices, in the order of their numbers in messages. */\nexport const choices = {\n";
  for (const PictureField& field : picture_fields()) {
    if (field.value.kind != FieldKind::kChoice) continue;
    std::string names;
    for (const std::string_view name : names_of_choice(field.form))
      names += (names.empty() ? "" : ", ") + in_quotes(name);
    text += "  " + camel_case(field.name) + ": [" + names + "],\n";
  }
  return text +
         "} as const;\n\nexport type Choice<Name extends keyof typeof choices> = (typeof choices)[Name][number];\n\n";
}

}  // namespace

std::string typescript_options() {
  std::string text = std::string(kTypescriptHead) + choices();
  text += "/** The options of a link that are one value. */\nexport interface PlainOptions {\n";
  text += lines([](const PictureField& field) {
    return wrapped(field.help, "  // ", kLineWidth) + "  readonly " + camel_case(field.name) + ": " + type_of(field) +
           ";";
  });
  text += "}\n\n/** Those of a link that does not state them. */\nexport const defaultPlain: PlainOptions = {\n";
  text +=
      lines([](const PictureField& field) { return "  " + camel_case(field.name) + ": " + default_of(field) + ","; });
  text += "};\n\n/** What is missing or wrong has its default. */\n";
  text += "export const plainIn = (values: URLSearchParams): PlainOptions => ({\n";
  text += lines([](const PictureField& field) {
    const std::string name = camel_case(field.name);
    return "  " + name + ": " + reading(field) + " ?? defaultPlain." + name + ",";
  });
  text += "});\n\n/** The parameters that differ from their defaults; the others are undefined. */\n";
  text += "export const plainParameters = (options: PlainOptions): Record<string, string | undefined> => ({\n";
  text += lines([](const PictureField& field) { return "  " + std::string(field.name) + ": " + writing(field) + ","; });
  text += "});\n\n/** The members of a message. */\n";
  text += "export const plainMembers = (options: PlainOptions) =>\n  ({\n";
  text += lines([](const PictureField& field) { return "    " + message_member(field) + ","; });
  return text + "  }) satisfies MessageInitShape<typeof DrawPictureSchema>;\n";
}

}  // namespace surfcast::protocol
