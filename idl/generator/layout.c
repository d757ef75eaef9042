#include "layout.h"

#include <inttypes.h>

static const char *base_layout(const idl_type_spec_t *type) {
  switch (idl_type(type)) {
    case IDL_BOOL: return "bool";
    case IDL_CHAR: return "char";
    case IDL_INT8: return "i8";
    case IDL_OCTET:
    case IDL_UINT8: return "u8";
    case IDL_SHORT:
    case IDL_INT16: return "i16";
    case IDL_USHORT:
    case IDL_UINT16: return "u16";
    case IDL_LONG:
    case IDL_INT32: return "i32";
    case IDL_ULONG:
    case IDL_UINT32: return "u32";
    case IDL_LLONG:
    case IDL_INT64: return "i64";
    case IDL_ULLONG:
    case IDL_UINT64: return "u64";
    case IDL_FLOAT: return "f32";
    case IDL_DOUBLE: return "f64";
    default: return "?";
  }
}

static void add_dimensions(text_t *out, const idl_declarator_t *declarator) {
  for (const idl_literal_t *size = declarator->const_expr; size; size = idl_next(size))
    text_add(out, "[%" PRIu32 "]", size->value.uint32);
}

static void add_type_layout(text_t *out, const idl_type_spec_t *type) {
  if (idl_is_declarator(type)) { /* the name of a typedef */
    add_dimensions(out, type);
    add_type_layout(out, idl_type_spec(type));
  } else if (idl_is_sequence(type)) {
    text_add(out, "[]");
    add_type_layout(out, idl_type_spec(type));
  } else if (idl_is_string(type)) {
    text_add(out, "string");
  } else if (idl_is_struct(type)) {
    add_layout(out, type);
  } else if (idl_is_enum(type)) {
    text_add(out, "enum{");
    for (const idl_enumerator_t *e = ((const idl_enum_t *)type)->enumerators; e; e = idl_next(e))
      text_add(out, "%s=%" PRIu32 ";", idl_identifier(e), e->value.value);
    text_add(out, "}");
  } else {
    text_add(out, "%s", base_layout(type));
  }
}

void add_layout(text_t *out, const idl_struct_t *type) {
  text_add(out, "{");
  for (field_t field = {NULL, NULL}; next_field(type, &field);) {
    text_add(out, "%s%s:", field.member->key.value ? "*" : "", idl_identifier(field.declarator));
    add_dimensions(out, field.declarator);
    add_type_layout(out, field.member->type_spec);
    if (field.member->unit.annotation) text_add(out, "[%s]", field.member->unit.value);
    text_add(out, ";");
  }
  text_add(out, "}");
}

uint64_t hash_of(const text_t *text) {
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (size_t i = 0; i < text->length; ++i) hash = (hash ^ (unsigned char)text->data[i]) * UINT64_C(0x100000001b3);
  return hash;
}
