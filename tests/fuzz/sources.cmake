# What the fuzzers compile again, by room and file; the tests `fuzzed.*` say what is missing here.
set(fuzzed_parsers
  io/scan io/triangles io/stl io/off io/ply io/obj io/tets io/tet_shape io/msh io/msh_cell io/inp
  io/inp_deck io/inp_sets
  mesh/tets/boundary mesh/numbering mesh/tets/order mesh/patches mesh/tets/quality mesh/surface mesh/tets/triangle)
set(fuzzed_measured
  base/atomic_file base/control_group base/memory base/quantity modal/frf_set io/channel_names
  io/csv io/csv_table
  io/frf_csv io/frf_uff io/frf_units io/measurable io/room io/scan io/time_csv io/time_uff io/uff
  io/uff_binary io/uff_channels io/uff_function io/uff_lines io/uff_shape io/uff_systems io/uff_write
  app/study_source io/escape io/json io/message io/shape_table)
