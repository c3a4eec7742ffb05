%prog1
(uccnc_post --no-show-editor )
(Exported by FreeCAD for UC-CNC)
(Post Processor: uccnc_post, version 0.0.4)
(Units: 'mm' and 'mm/min')
(preamble: begin)
G17 (Default: XY-plane)
G54 (Default: First coordinate system)
G40 (Default: Cutter radius compensation none)
G49 (Default: Tool Length Offsets: cancel tool length)
G90 (Default: Absolute distance mode selection)
G80 (Cancel canned cycle)
(preamble: done)
(operation initialise: TC: Default Tool)
(operation start: TC: Default Tool)
(TC: Default Tool)
M6 T1
M3 S8000
(operation done: TC: Default Tool)
(operation finalised: TC: Default Tool)
(operation initialise: Pocket_Offset)
(operation start: Pocket_Offset)
(Pocket_Offset)
G0 Z18.000
G0 X57.119 Y32.119
G0 Z16.000
G1 Z9.000 F200.000
G3 X54.940 Y33.000 I-2.129 J-2.129 K0.000 F600.000
G1 X25.060
G3 X22.000 Y29.940 I-0.051 J-3.010
G1 Y20.060
G3 X25.060 Y17.000 I3.010 J-0.051
G1 X54.940
G3 X58.000 Y20.060 I0.051 J3.010
G1 Y29.940
G3 X57.119 Y32.119 I-3.010 J0.051
G0 Z18.000
G0 X55.419 Y30.419
G0 Z16.000
G1 Z9.000 F200.000
G3 X54.867 Y30.600 I-0.455 J-0.455 F600.000
G1 X25.133 Y30.600
G3 X24.400 Y29.867 I-0.096 J-0.637
G1 Y20.133
G3 X25.133 Y19.400 I0.637 J-0.096
G1 X54.867
G3 X55.600 Y20.133 I0.096 J0.637
G1 Y29.867
G3 X55.419 Y30.419 I-0.637 J0.096
G0 Z18.000
G0 X53.200 Y28.200
G0 Z16.000
G1 Z9.000 F200.000
G1 X26.800 F600.000
G1 Y21.800
G1 X53.200
G1 Y28.200
G0 Z18.000
G0 X50.800 Y25.800
G0 Z16.000
G1 Z9.000 F200.000
G1 X29.200 F600.000
G1 Y24.200
G1 X50.800
G1 Y25.800
G1 Z6.000 F200.000
G1 X29.200 F600.000
G1 Y24.200
G1 X50.800
G1 Y25.800
G0 Z18.000
G0 Y28.200
G0 Z16.000
G1 Z6.000 F200.000
G1 X26.800 F600.000
G1 Y21.800
G1 X53.200
G1 Y28.200
G1 X50.800
G0 Z18.000
G0 Y30.600
G0 Z16.000
G1 Z6.000 F200.000
G1 X25.133 F600.000
G3 X24.400 Y29.867 I-0.096 J-0.637
G1 Y20.133
G3 X25.133 Y19.400 I0.637 J-0.096
G1 X54.867
G3 X55.600 Y20.133 I0.096 J0.637
G1 Y29.867
G3 X54.867 Y30.600 I-0.637 J0.096
G1 X50.800
G0 Z18.000
G0 Y33.000
G0 Z16.000
G1 Z6.000 F200.000
G1 X25.060 F600.000
G3 X22.000 Y29.940 I-0.051 J-3.010
G1 Y20.060
G3 X25.060 Y17.000 I3.010 J-0.051
G1 X54.940
G3 X58.000 Y20.060 I0.051 J3.010
G1 Y29.940
G3 X54.940 Y33.000 I-3.010 J0.051
G1 X50.800
G0 Z18.000
G0
(operation done: Pocket_Offset)
(operation finalised: Pocket_Offset)
(postamble: begin)
M05 (stop spindle)
G17 (Default: XY-plane)
G54 (Default: First coordinate system)
G40 (Default: Cutter radius compensation none)
G90 (Default: Absolute distance mode selection)
G80 (Cancel canned cycle)
M30 (Stop program and rewind code)
(postamble: done)
