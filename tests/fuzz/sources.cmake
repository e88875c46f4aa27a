# What the fuzzers compile again, by room and file; the tests `fuzzed.*` say what is missing here.
set(fuzzed_parsers
  io/bytes/scan io/surface/triangles io/surface/stl io/surface/off io/surface/ply io/surface/obj
  io/cells/tets io/cells/tet_shape io/cells/msh io/cells/msh_cell io/cells/inp io/cells/inp_deck
  io/cells/inp_sets mesh/tets/boundary mesh/numbering mesh/tets/order mesh/patches
  mesh/soundness/material mesh/soundness/shells mesh/tets/quality mesh/surface mesh/tets/triangle)
set(fuzzed_measured
  base/interrupt base/quantity host/atomic_file host/input_file host/limits/control_group host/memory modal/frf_set
  io/measured/channel_names io/measured/column_head io/bytes/csv io/bytes/csv_table io/measured/frf_csv io/uff/frf_uff
  io/measured/frf_units io/measured/measurable io/bytes/room io/bytes/scan io/bytes/scratch_file
  io/measured/measured_format io/measured/recordings_file io/measured/time_columns
  io/measured/time_csv io/bytes/gzip io/uff/node_shapes io/uff/time_uff
  io/uff/time_uff_write io/uff/uff_recordings io/uff/uff io/uff/uff_binary
  io/uff/uff_channels io/uff/uff_fields io/uff/uff_function io/uff/uff_geometry io/uff/uff_lines
  io/uff/uff_shape io/uff/uff_systems io/uff/uff_write study/toml/study_source io/bytes/escape
  io/bytes/json io/bytes/message io/measured/shape_table)
