#include "cpp.h"

#include <ctype.h>
#include <inttypes.h>
#include <string.h>

#include "layout.h"

/* ------------------------------------------------------------------------------------------------------- types */

static const char *base_cpp(const idl_type_spec_t *type) {
  switch (idl_type(type)) {
    case IDL_BOOL: return "bool";
    case IDL_CHAR: return "char";
    case IDL_INT8: return "std::int8_t";
    case IDL_OCTET:
    case IDL_UINT8: return "std::uint8_t";
    case IDL_SHORT:
    case IDL_INT16: return "std::int16_t";
    case IDL_USHORT:
    case IDL_UINT16: return "std::uint16_t";
    case IDL_LONG:
    case IDL_INT32: return "std::int32_t";
    case IDL_ULONG:
    case IDL_UINT32: return "std::uint32_t";
    case IDL_LLONG:
    case IDL_INT64: return "std::int64_t";
    case IDL_ULLONG:
    case IDL_UINT64: return "std::uint64_t";
    case IDL_FLOAT: return "float";
    case IDL_DOUBLE: return "double";
    default: return "void";
  }
}

static void add_cpp_type(text_t *out, const idl_type_spec_t *type);

/* `long a[2][3]` is std::array<std::array<std::int32_t, 3>, 2>. */
static void add_array(text_t *out, const idl_literal_t *size, const idl_type_spec_t *element) {
  if (!size) {
    add_cpp_type(out, element);
    return;
  }
  text_add(out, "std::array<");
  add_array(out, idl_next(size), element);
  text_add(out, ", %" PRIu32 ">", size->value.uint32);
}

static void add_cpp_type(text_t *out, const idl_type_spec_t *type) {
  if (idl_is_declarator(type)) { /* the name of a typedef, perhaps of an array */
    add_array(out, ((const idl_declarator_t *)type)->const_expr, idl_type_spec(type));
  } else if (idl_is_sequence(type)) {
    text_add(out, "std::vector<");
    add_cpp_type(out, idl_type_spec(type));
    text_add(out, ">");
  } else if (idl_is_string(type)) {
    text_add(out, "std::string");
  } else if (idl_is_struct(type) || idl_is_enum(type)) {
    text_add(out, "::");
    add_scoped_name(out, type, "::");
  } else {
    text_add(out, "%s", base_cpp(type));
  }
}

/* ------------------------------------------------------------------------------------------------- header parts */

static void add_quoted(text_t *out, const char *value) {
  text_add(out, "\"");
  for (; *value; ++value) {
    if (*value == '"' || *value == '\\')
      text_add(out, "\\%c", *value);
    else if (isprint((unsigned char)*value))
      text_add(out, "%c", *value);
    else
      text_add(out, "\\%03o", (unsigned)(unsigned char)*value);
  }
  text_add(out, "\"");
}

static void add_floating(text_t *out, double value, int digits, const char *suffix) {
  const size_t before = out->length;
  text_add(out, "%.*g", digits, value);
  if (!strpbrk(out->data + before, ".e")) text_add(out, ".0");
  text_add(out, "%s", suffix);
}

static void add_constant(text_t *out, const idl_const_t *constant) {
  const idl_type_spec_t *type = innermost_type(constant->type_spec);
  const idl_literal_t *literal = constant->const_expr;
  text_add(out, "inline constexpr ");
  if (idl_is_string(type))
    text_add(out, "std::string_view");
  else
    add_cpp_type(out, type);
  text_add(out, " %s = ", idl_identifier(constant));
  if (idl_is_enum(type)) {
    add_cpp_type(out, type);
    text_add(out, "::%s", idl_identifier(constant->const_expr));
  } else if (idl_is_string(type)) {
    add_quoted(out, literal->value.str);
  } else {
    switch (idl_type(type)) {
      case IDL_BOOL: text_add(out, "%s", literal->value.bln ? "true" : "false"); break;
      case IDL_CHAR: text_add(out, "static_cast<char>(%d)", literal->value.chr); break;
      case IDL_INT8: text_add(out, "%d", literal->value.int8); break;
      case IDL_OCTET:
      case IDL_UINT8: text_add(out, "%u", literal->value.uint8); break;
      case IDL_SHORT:
      case IDL_INT16: text_add(out, "%d", literal->value.int16); break;
      case IDL_USHORT:
      case IDL_UINT16: text_add(out, "%u", literal->value.uint16); break;
      case IDL_LONG:
      case IDL_INT32: text_add(out, "static_cast<std::int32_t>(%" PRId32 "L)", literal->value.int32); break;
      case IDL_ULONG:
      case IDL_UINT32: text_add(out, "%" PRIu32 "U", literal->value.uint32); break;
      case IDL_LLONG:
      case IDL_INT64:
        /* The least 64-bit number cannot be written as a literal with a minus before it. */
        text_add(out, "static_cast<std::int64_t>(0x%" PRIx64 "ULL)", (uint64_t)literal->value.int64);
        break;
      case IDL_ULLONG:
      case IDL_UINT64: text_add(out, "%" PRIu64 "ULL", literal->value.uint64); break;
      case IDL_FLOAT: add_floating(out, (double)literal->value.flt, 9, "f"); break;
      case IDL_DOUBLE: add_floating(out, literal->value.dbl, 17, ""); break;
      default: break;
    }
  }
  text_add(out, ";\n");
}

static void add_enum(text_t *out, const idl_enum_t *type) {
  const char *name = idl_identifier(type);
  text_add(out, "enum class [[gnu::visibility(\"default\")]] %s : std::int32_t {\n", name);
  for (const idl_enumerator_t *e = type->enumerators; e; e = idl_next(e))
    text_add(out, "  %s = %" PRIu32 ",\n", idl_identifier(e), e->value.value);
  text_add(out, "};\n\n");

  text_add(
      out,
      "/// Whether the value is one of the enumerators.\nconstexpr bool is_valid(%s value) {\n  switch (value) {\n",
      name);
  for (const idl_enumerator_t *e = type->enumerators; e; e = idl_next(e))
    text_add(out, "    case %s::%s:\n", name, idl_identifier(e));
  text_add(out, "      return true;\n  }\n  return false;\n}\n\n");

  text_add(out,
           "/// The enumerator's name; empty if there is none of that value.\n"
           "constexpr std::string_view to_string(%s value) {\n  switch (value) {\n",
           name);
  for (const idl_enumerator_t *e = type->enumerators; e; e = idl_next(e))
    text_add(out, "    case %s::%s: return \"%s\";\n", name, idl_identifier(e), idl_identifier(e));
  text_add(out, "  }\n  return {};\n}\n");
}

static void add_struct(text_t *out, const idl_struct_t *type) {
  const char *name = idl_identifier(type);
  text_add(out, "struct [[gnu::visibility(\"default\")]] %s {\n", name);
  for (field_t field = {NULL, NULL}; next_field(type, &field);) {
    text_add(out, "  ");
    add_array(out, field.declarator->const_expr, field.member->type_spec);
    text_add(out, " %s{};", idl_identifier(field.declarator));
    if (field.member->unit.annotation || field.member->key.value) {
      text_add(out, "  ///<%s", field.member->key.value ? " key" : "");
      if (field.member->unit.annotation) text_add(out, " [%s]", field.member->unit.value);
    }
    text_add(out, "\n");
  }
  text_add(out, "\n  bool operator==(const %s&) const = default;\n};\n\n", name);

  text_add(out,
           "template <class Visitor, class Message>\n  requires std::is_same_v<std::remove_cv_t<Message>, %s>\n"
           "constexpr void fields(Visitor&& visit, Message& message) {\n",
           name);
  for (field_t field = {NULL, NULL}; next_field(type, &field);) {
    text_add(out, "  visit(::kervan::Field{\"%s\", ", idl_identifier(field.declarator));
    add_quoted(out, field.member->unit.annotation ? field.member->unit.value : "");
    text_add(out, ", %s}, message.%s);\n", field.member->key.value ? "true" : "false",
             idl_identifier(field.declarator));
  }
  text_add(out, "}\n");
}

/* ------------------------------------------------------------------------------------------------- whole files */

typedef struct writer {
  text_t *out;
  const idl_pstate_t *state;
} writer_t;

static void open_scope(text_t *out, const void *node) {
  text_add(out, "\nnamespace ");
  add_scope(out, node, "::");
  text_add(out, " {\n\n");
}

static void close_scope(text_t *out, const void *node) {
  text_add(out, "\n}  // namespace ");
  add_scope(out, node, "::");
  text_add(out, "\n");
}

static void add_declaration(const void *node, void *argument) {
  text_t *out = ((writer_t *)argument)->out;
  if (!idl_is_const(node) && !idl_is_enum(node) && !idl_is_struct(node)) return; /* typedefs are resolved where used */
  open_scope(out, node);
  if (idl_is_const(node)) {
    add_constant(out, node);
  } else if (idl_is_enum(node)) {
    add_enum(out, node);
  } else {
    add_struct(out, node);
  }
  close_scope(out, node);
}

static void add_type_support_declaration(const void *node, void *argument) {
  text_t *out = ((writer_t *)argument)->out;
  if (!idl_is_struct(node)) return;
  if (is_keyed(node)) {
    text_add(out, "template <>\ninline constexpr bool is_keyed<::");
    add_scoped_name(out, node, "::");
    text_add(out, "> = true;\n");
  }
  text_add(out, "template <>\ninline constexpr std::uint64_t compiled_layout<::");
  add_scoped_name(out, node, "::");
  text_t layout = {NULL, 0, 0};
  add_layout(&layout, node);
  text_add(out, "> = 0x%016" PRIx64 ";\n", hash_of(&layout));
  text_free(&layout);
  text_add(out, "template <>\n[[gnu::visibility(\"default\")]] const TypeSupport& type_support<::");
  add_scoped_name(out, node, "::");
  text_add(out, ">();\n");
}

void add_header(text_t *out, const idl_pstate_t *state, const char *self) {
  writer_t writer = {out, state};
  text_add(out, "// Generated from %s.idl; do not edit.\n#pragma once\n\n", self);
  text_add(out,
           "#include <array>\n#include <cstdint>\n#include <string>\n#include <string_view>\n#include <type_traits>\n"
           "#include <vector>\n\n#include \"framework/dds/message.hpp\"\n");
  for (const idl_source_t *source = state->sources->includes; source; source = source->next) {
    text_add(out, "#include \"");
    add_file_name(out, source->path->name);
    text_add(out, ".hpp\"\n");
  }
  for_each_definition(state, add_declaration, &writer);
  text_add(out, "\nnamespace kervan {\n\n");
  for_each_definition(state, add_type_support_declaration, &writer);
  text_add(out, "\n}  // namespace kervan\n");
}

static void add_type_support(const void *node, void *argument) {
  text_t *out = ((writer_t *)argument)->out;
  if (!idl_is_struct(node)) return;
  text_t name = {NULL, 0, 0}, scope = {NULL, 0, 0};
  add_scoped_name(&name, node, "::");
  add_scope(&scope, node, "::");
  text_add(out, "\ntemplate <>\nconst TypeSupport& type_support<::%s>() {\n", name.data);
  text_add(out, "  static constexpr TypeSupport support = make_type_support<::%s>({\n", name.data);
  text_add(out, "      .name = \"%s\",\n", name.data);
  /* ROS 2 puts its wire types into a module dds_ and adds an underscore. */
  text_add(out, "      .wire_name = \"%s::dds_::%s_\",\n", scope.data, idl_identifier(node));
  text_add(out, "      .layout_hash = compiled_layout<::%s>,\n", name.data);
  if (idl_is_topic(node, false)) {
    text_add(out, "      .descriptor = &");
    add_scoped_name(out, node, "_");
    text_add(out, "_desc,\n");
  } else {
    text_add(out, "      .descriptor = nullptr,  // @nested\n");
  }
  text_add(out, "  });\n  return support;\n}\n");
  text_free(&name);
  text_free(&scope);
}

void add_source(text_t *out, const idl_pstate_t *state, const char *self) {
  writer_t writer = {out, state};
  text_add(out, "// Generated from %s.idl; do not edit.\n#include \"%s.hpp\"\n\n", self, self);
  text_add(out, "#include \"%s.h\"\n#include \"framework/dds/type_support_impl.hpp\"\n\nnamespace kervan {\n", self);
  for_each_definition(state, add_type_support, &writer);
  text_add(out, "\n}  // namespace kervan\n");
}
