"""Small programs that are right, one for each profile: a square with rounded corners."""

from __future__ import annotations

from typing import Final

ISO: Final = """\
G17 G21 G40 G49 G54 G80 G90 G94
G91.1
G61
T1 M6
G43 H1
S3000 M3
M8
G4 P2
G0 Z5.0
G0 X-20.0 Y0.0
G1 Z-3.0 F100
G1 X-10.0 F300
G1 Y5.0
G2 X-5.0 Y10.0 I5.0 J0.0
G1 X5.0
G2 X10.0 Y5.0 I0.0 J-5.0
G1 Y-5.0
G2 X5.0 Y-10.0 I-5.0 J0.0
G1 X-5.0
G2 X-10.0 Y-5.0 I0.0 J5.0
G1 Y0.0
G1 X-20.0
G0 Z5.0
M9
M5
M2
"""

FRAMED: Final = (
    ISO.replace("G91.1\nG61\n", "")
    .replace("G43 H1\n", "")
    .replace("G4 P2", "G4 P2000")
    .replace("G0 Z5.0\nG0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0\nG0 G43 Z5.0 H1\n")
    .replace("G0 Z5.0\nM9\nM5\nM2\n", "G0 Z5.0\nM9\nM5\n@\nM30\n%\n")
)

GOOD: Final = {
    "linuxcnc": ISO,
    "mach3": ISO.replace("M2\n", "M30\n"),
    "grbl": ISO.replace("T1 M6\nG43 H1\n", ""),
    "fanuc": "%\nO1001\nG91 G28 Z0.\nG90\n" + FRAMED.replace("@", "G91 G28 Z0.\nG90"),
    "haas": "%\nO01001\nG0 G53 Z0.\n"
    + FRAMED.replace("@", "G0 G53 Z0.").replace("F100", "F100.").replace("F300", "F300."),
    "sinumerik": (
        ISO.replace("G17 G21 G40 G49 G54 G80 G90 G94", "G17 G710 G40 G90 G94\nG54")
        .replace("G91.1\nG61\nT1 M6\nG43 H1\n", "SUPA G0 Z0 D0\nT1\nM6\nD1\nCYCLE832(0.005,1,1)\n")
        .replace("G4 P2", "G4 F2")
        .replace("G0 Z5.0\nG0 X-20.0 Y0.0\n", "G0 X-20.0 Y0.0\nG0 Z5.0\n")
        .replace("M2\n", "CYCLE832()\nM30\n")
    ),
    "heidenhain": """\
0 BEGIN PGM SQUARE MM
1 BLK FORM 0.1 Z X-12 Y-12 Z-5
2 BLK FORM 0.2 X+12 Y+12 Z+0
3 CYCL DEF 247 DATUM SETTING Q339=+1
4 L Z+0 R0 FMAX M91
5 TOOL CALL 1 Z S3000
6 CYCL DEF 32.0 TOLERANCE
7 CYCL DEF 32.1 T0.005
8 M3
9 M8
10 CYCL DEF 9.0 DWELL TIME
11 CYCL DEF 9.1 DWELL 2
12 L X-20.0 Y+0.0 R0 FMAX
13 L Z+5.0 R0 FMAX
14 L Z-3.0 R0 F100
15 L X-10.0 R0 F300
16 L Y+5.0 R0
17 CC X-5.0 Y+5.0
18 C X-5.0 Y+10.0 DR- R0
19 L X+5.0 R0
20 CC X+5.0 Y+5.0
21 C X+10.0 Y+5.0 DR- R0
22 L Y-5.0 R0
23 CC X+5.0 Y-5.0
24 C X+5.0 Y-10.0 DR- R0
25 L X-5.0 R0
26 CC X-5.0 Y-5.0
27 C X-10.0 Y-5.0 DR- R0
28 L Y+0.0 R0
29 L X-20.0 R0
30 L Z+5.0 R0 FMAX
31 M9
32 M5
33 L Z+0 R0 FMAX M91
34 M30
35 END PGM SQUARE MM
""",
}
