/// CDR of generated messages: what the wire carries.
#pragma once

#include "framework/dds/cdr_reader.hpp"
#include "framework/dds/cdr_writer.hpp"
