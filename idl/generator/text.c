#include "text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void text_add(text_t *text, const char *format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int added = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  if (added < 0) abort();
  const size_t needed = text->length + (size_t)added + 1;
  if (needed > text->capacity) {
    const size_t capacity = needed > 2 * text->capacity ? needed : 2 * text->capacity;
    char *data = realloc(text->data, capacity);
    if (!data) abort();
    text->data = data;
    text->capacity = capacity;
  }
  vsnprintf(text->data + text->length, (size_t)added + 1, format, again);
  va_end(again);
  text->length += (size_t)added;
}

void text_free(text_t *text) {
  free(text->data);
  *text = (text_t){NULL, 0, 0};
}
