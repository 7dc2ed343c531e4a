"""Headers of text tables: settings with more cells than the table, and two rows of names one below the other."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed, guesses
from gear_damping.measurement.inspection import inspect_table

SETTINGS = [
    "Date:;2020-07-06 15:34:41",
    "Index:;0x30D3;0x30D2;0x0000;0x0000",
    "Recorded samples:;60",
    "Scale:;0;True;5.000;101.500;-121.500;-81.500",
]
TRIGGER = 'Trigger:;1;0.000000;"Parameter values";"Channel 1";"Rising above value"'
QUOTED = '"Trigger:;1;0.000000;""Parameter values"";""Channel 1"";""Rising above value"""'
NAMES = [";Velocity;Torque", "ms;rpm;%"]


def table_of(folder, lines):
    (folder / "run.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_table(folder / "run.csv")


def rows(n, cells=3, sign=";"):
    return [sign.join(f"{k + 0.5 * j:.3f}" for j in range(cells)) for k in range(n)]


@pytest.mark.parametrize("trigger", [TRIGGER, QUOTED])
def test_settings_with_more_cells_than_the_table_are_left_out(tmp_path, trigger):
    table = table_of(tmp_path, [*SETTINGS, trigger, *NAMES, *rows(60)])
    assert table.names == ("", "Velocity", "Torque")
    assert [table.unit(k) for k in range(3)] == ["ms", "rpm", "%"]
    assert [len(table.values(k)) for k in range(3)] == [60, 60, 60]
    assert table.notes == ("run.csv: 5 line(s) above the values are left out",)


def test_names_of_two_columns_stand_below_settings_of_a_name_and_a_number_each(tmp_path):
    settings = ["Model,X30", "", "Point Format,Y,", "Horizontal Units,S,", "Horizontal Scale,0.04,"]
    settings += ["Sample Interval,5E-03,", "Record Length,60,", "Vertical Units,V,", "Vertical Offset,0,", "Label,,"]
    table = table_of(tmp_path, [*settings, "TIME,CH1", *rows(60, 2, ",")])
    assert table.names[:2] == ("TIME", "CH1")
    assert [len(table.values(k)) for k in range(2)] == [60, 60]


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        ("cp932", "変位"),
        ("cp932", "加速度センサ"),
        ("cp932", "データ1"),
        ("cp932", "変位\u3000"),
        ("cp1252", "Größe"),
        ("cp1252", "créée"),
        ("cp1252", "Aceleração"),
        ("cp1252", "gemäß"),
        ("cp1252", "±µ"),
        ("cp1252", "«École»"),
        ("cp1252", "Young’s"),
        ("cp1252", "Weg „A“"),
        ("utf-8", "変位"),
        ("utf-16", "変位"),
    ],
)
def test_names_are_read_in_the_code_pages_of_older_programs(tmp_path, encoding, name):
    lines = [f"t,{name} [mm]", *rows(60, 2, ",")]
    (tmp_path / "run.csv").write_bytes("\n".join(lines).encode(encoding))
    table = read_table(tmp_path / "run.csv")
    assert table.names[1] == f"{name} [mm]"
    assert table.unit(1) == "mm"


@pytest.mark.parametrize(
    "lines",
    [
        ["x,v", "-,0.5", *rows(28, 2, ","), "-,-", *rows(30, 2, ",")],
        ["a,b", ",0.5", *rows(20, 2, ","), "a,b", ",0.5", *rows(30, 2, ",")],
    ],
    ids=["a row of blanks", "two blocks"],
)
def test_no_row_of_values_is_taken_for_settings(tmp_path, lines):
    table = table_of(tmp_path, lines)
    assert table.names == tuple(lines[0].split(","))
    assert len(table.values(1)) >= len(lines) - 3


def test_a_row_with_too_many_cells_is_a_fault_and_no_setting(tmp_path):
    with pytest.raises(InputError, match=r"row 2 \(line 4\): 4 cells where the first line has 3"):
        table_of(tmp_path, ["a;b;c", *rows(2), "1;2;3;4", *rows(60)])
    with pytest.raises(InputError, match="4 cells where the first line has 3"):
        table_of(tmp_path, [*rows(2), "1;2;3;4", "a;b;c", *rows(60)])


def test_a_figure_that_a_sheet_left_beside_the_first_row_takes_no_header_away(tmp_path):
    first = rows(1)[0] + ";;93,29286191"
    table = table_of(tmp_path, ["seconds;speed;torque;;", first, *[row + ";;" for row in rows(60)[1:]]])
    assert table.names[:3] == ("seconds", "speed", "torque")
    assert len(table.values(0)) == 60
    assert not any("left out" in note for note in table.notes)


SERVO = [
    "Axis1",
    "Sampling time interval(ms),0.667",
    "Time,Analog 1,Analog 2,Analog 3,Analog 4,Digital 1",
    "ms,Servo motor speed,Torque (%),Not selected,Not selected,Torque",
]


def test_a_row_of_units_and_names_below_generic_names_is_read(tmp_path):
    table = table_of(tmp_path, [*SERVO, *rows(40, 6, ",")])
    assert table.names == ("Time", "Servo motor speed", "Torque (%)", "Analog 3", "Analog 4", "Torque")
    assert [table.unit(k) for k in range(6)] == ["ms", None, "%", None, None, None]
    assert inspect_table(table).rate == pytest.approx(1000.0)
    assert table.notes == (
        "run.csv: 2 line(s) above the values are left out",
        "run.csv: of two rows of names the lower one gives units, 'Servo motor speed' for 'Analog 1', 'Torque (%)' for "
        "'Analog 2', 'Torque' for 'Digital 1'; left out of it: Not selected",
    )


def test_a_unit_that_nobody_knows_does_not_make_a_row_of_units_one_of_names(tmp_path):
    table = table_of(tmp_path, ["Time,Force,Strain", "s,kN,ue", *rows(40, 3, ",")])
    assert table.names == ("Time", "Force", "Strain")
    assert [table.unit(k) for k in range(3)] == ["s", "kN", None]


def test_of_two_rows_without_a_unit_of_time_the_lower_one_names(tmp_path):
    table = table_of(tmp_path, ["Time,Left,Right", "t,V,x", *rows(40, 3, ",")])
    assert table.names == ("t", "V", "x")


def test_lines_of_settings_above_a_definition_of_the_columns_are_no_values(tmp_path):
    body = [row.replace(".", ",") for row in rows(30, sign="\t")]
    head = ["MIN=0\t-0,4\t-4", "MAX=60\t0,4\t4", "DEC=1\t4\t2", 'DEF="Zeit" t / s\t"Weg" s_A1 / m\t"Winkel" w / rad']
    table = table_of(tmp_path, [*head, *body])
    assert table.names == ("Zeit t / s", "Weg s_A1 / m", "Winkel w / rad")
    assert [table.unit(k) for k in range(3)] == ["s", "m", "rad"]
    assert len(table.values(0)) == 30


def test_lines_of_settings_that_define_no_column_are_counted_once(tmp_path):
    table = table_of(tmp_path, ["MIN=0\t-0.4", "MAX=60\t0.4", *rows(30, 2, "\t")])
    assert table.names == ("", "")
    assert table.notes == ("run.csv: 2 line(s) above the values are left out",)


@pytest.mark.parametrize("above", [["12.5", "3", "0.001"], ["12.5", "3", "0.001", "7", "1"], ["12.5,3", "7", "1"]])
def test_numbers_above_the_names_that_are_fewer_than_the_columns_are_no_values(tmp_path, above):
    table = table_of(tmp_path, [*above, "time,left,right", *rows(30, 3, ",")])
    assert table.names == ("time", "left", "right")
    assert len(table.values(0)) == 30
    assert table.notes == (f"run.csv: {len(above)} line(s) above the values are left out",)


def test_names_with_blanks_between_them_stand_above_rows_with_tabs(tmp_path):
    assert table_of(tmp_path, ["t       y", *rows(30, 2, "\t")]).names == ("t", "y")
    titled = table_of(tmp_path, ["swing of the spring", *rows(30, 2, "\t")])
    assert titled.names == ("", "")
    assert "1 line(s) above the values" in titled.notes[0]


def test_channels_that_an_oscilloscope_numbers_have_the_units_below(tmp_path):
    table = table_of(tmp_path, ["x-axis,1,2", "second,Volt,Volt", *rows(60, sign=",")])
    assert table.names == ("x-axis", "1", "2")
    assert [table.unit(k) for k in range(3)] == ["second", "Volt", "Volt"]
    assert len(table.values(table.index("2", "column"))) == 60


def test_a_row_of_numbers_behind_a_text_names_nothing_where_they_are_no_numbers_of_channels(tmp_path):
    table = table_of(tmp_path, ["scale,0.5,0.5", "second,Volt,Volt", *rows(60, sign=",")])
    assert table.names == ("second", "Volt", "Volt")


def test_a_column_may_be_asked_for_by_any_row_of_the_header(tmp_path):
    devices = "MX840B Time;MX840B CH 1;MX840B CH 2"
    table = table_of(tmp_path, ["Time [s];Shaker [N];Mass [mm]", devices, "s;N;mm", *rows(40)])
    assert table.names == tuple(devices.split(";"))
    assert [table.index(name, "column") for name in ("Time [s]", "Mass [mm]", "MX840B CH 2")] == [0, 2, 2]
    with pytest.raises(InputError, match="2 columns bear this name"):
        table_of(tmp_path, ["Time;Force;Force", "t;x;y", "s;N;mm", *rows(40)]).index("Force", "column")


SCOPE = ["X,CH1,CH2,Start,Increment,", "Sequence,Volt,Volt,-1.200000e-02,2.000000e-05"]


def test_an_oscilloscope_states_start_and_step_beside_the_names_of_its_columns(tmp_path):
    table = table_of(tmp_path, [*SCOPE, *[f"{k},{0.1 * k:.2f},{-0.2 * k:.2f}," for k in range(40)]])
    assert table.names == ("X", "CH1", "CH2")
    assert [table.unit(k) for k in range(3)] == [None, "Volt", "Volt"]
    assert len(table.values(2)) == 40
    assert table.stated_rate[1] == pytest.approx(50e3)
    assert not table.notes


def test_columns_named_start_and_increment_are_columns_where_rows_hold_them(tmp_path):
    table = table_of(tmp_path, ["X,Start,Increment", *rows(40, 3, ",")])
    assert table.names == ("X", "Start", "Increment")
    assert table.stated_rate is None


@pytest.mark.parametrize(
    ("header", "sign", "names"),
    [
        ("Zeit,1,2", ",", ("Zeit", "1", "2")),
        (",0,1", ",", ("", "0", "1")),  # pandas, of a frame without names
        ("Zeit;0,5;1,0", ";", ("Zeit", "0,5", "1,0")),
        ("1,2,3", ",", ("1", "2", "3")),
        ("0.5,1,2", ",", ("", "", "")),  # values
        ("OVL,1,2", ",", ("", "", "")),
    ],
)
def test_names_that_are_numbers_are_no_sample(tmp_path, header, sign, names):
    body = [row.replace(".", ",") if sign == ";" else row for row in rows(40, 3, sign)]
    table = table_of(tmp_path, [header, *body])
    assert table.names == names
    assert len(table.values(1)) == 40 + (names[1] == "")


@pytest.mark.parametrize("line", ["Channel 1: Hammer [N]", "Weg am Balken [mm]"])
def test_words_above_a_table_with_other_signs_between_its_cells_are_no_names(tmp_path, line):
    table = table_of(tmp_path, [line, *rows(40, 4, "\t")])
    assert table.names == ("",) * 4
    assert [table.unit(k) for k in range(4)] == [None] * 4
    named = table_of(tmp_path, ["time force left right", *rows(40, 4, "\t")])
    assert named.names == ("time", "force", "left", "right")


def test_settings_above_a_table_without_names_are_no_names(tmp_path):
    table = table_of(tmp_path, ["Header Size:\t2", "Channel 1:\tHammer [N]", *rows(40, 4, "\t")])
    assert table.names == ("",) * 4
    assert [table.unit(k) for k in range(4)] == [None] * 4


def test_a_unit_behind_a_stroke_need_not_be_written(tmp_path):
    table = table_of(tmp_path, ["t / s;x / mm;y/mm", *rows(40)])
    assert [table.index(name, "column") for name in ("t", "x / mm", "y/mm")] == [0, 1, 2]


def test_columns_with_commas_beside_others_with_points_are_named(tmp_path):
    table = table_of(tmp_path, ["t;x;y", *[f"{0.1 * k:.2f};{k},5;7" for k in range(40)]])
    assert table.notes == ("run.csv: read with decimal commas in x, beside decimal points in others",)


@pytest.mark.parametrize("sign", ["#", "% ", ""])
def test_a_row_of_units_in_brackets_is_none_of_names_though_some_are_unknown(tmp_path, sign):
    rows = "".join(f"{k / 20:.3f}\t{k % 7}\t{k / 20 + 0.01:.3f}\t{k % 5}\n" for k in range(40))
    path = tmp_path / "two.txt"
    path.write_text(f"{sign}Time A\tPos A\tTime B\tPos B\n{sign}[s]\t[au]\t[s]\t[au]\n{rows}")
    table = read_table(path)
    assert [name.strip() for name in table.names] == ["Time A", "Pos A", "Time B", "Pos B"]
    assert [table.unit(k) for k in range(4)] == ["s", "au", "s", "au"]
    assert table.values(1)[:3].tolist() == [0, 1, 2]


def test_a_row_above_that_is_shorter_than_the_table_names_what_it_can(tmp_path):
    """The head of an oscilloscope: settings in two cells, rows of nothing, and names."""
    above = "Model,MSO54\nLabel,,\nSample Interval,0.01,\nProbe Attenuation,10,\n,\n,\nTIME,CH1\n"
    rows = "\n".join(f"{k / 100:.5e},{np.cos(k / 9):.5f}" for k in range(60))
    (tmp_path / "scope.csv").write_text(above + rows + "\n")
    table = read_table(tmp_path / "scope.csv")
    assert table.names == ("TIME", "CH1")
    assert table.values(1).size == 60


@pytest.mark.parametrize(
    ("names", "firsts", "behind"),
    [
        (["Note"], [["start"]], 1), (["Temp"], [["21.5"]], 1), (["Temp", "Operator"], [["21.5", "AB"]], 2),
        (["Note", "Temp"], [["start", "21"], ["", "22"]], 2),
    ],
)  # fmt: skip
def test_columns_that_have_cells_in_the_first_rows_alone_leave_the_table_its_names(tmp_path, names, firsts, behind):
    values = rows(60, cells=2, sign=",")
    lines = [",".join([one, *more]) for one, more in zip(values, firsts, strict=False)]
    lines += [one + "," * behind for one in values[len(firsts) :]]
    table = table_of(tmp_path, ["Time,Disp," + ",".join(names), *lines])
    assert table.names == ("Time", "Disp", *names)
    assert table.values(1).size == 60
    assert not table.notes


def test_rows_that_say_before_the_columns_what_they_hold_are_the_header(tmp_path):
    head = ["imc FAMOS ASCII", "Name\tWeg\tKraft", "Einheit\tmm\tN", "X0\t0\t0", "DeltaX\t0,01\t0,01", ""]
    table = table_of(tmp_path, [*head, *(row.replace(".", ",") for row in rows(60, cells=2, sign="\t"))])
    assert table.names == ("Weg", "Kraft")
    assert [table.unit(k) for k in range(2)] == ["mm", "N"]
    assert table.stated_rate == ("DeltaX", pytest.approx(100.0))
    assert len(table.values(1)) == 60


def test_the_four_rows_above_a_table_of_a_logger(tmp_path):
    head = ['"TOA5","site","CR1000","1"', '"TIMESTAMP","RECORD","Disp"', '"TS","RN","mm"', '"","","Smp"']
    table = table_of(tmp_path, [*head, *(f'"2024-03-01 11:59:{k % 60:02d}",{k},{k / 7:.3f}' for k in range(50))])
    assert table.names == ("TIMESTAMP", "RECORD", "Disp")
    assert [table.unit(k) for k in range(3)] == ["s", None, "mm"]


def test_a_line_that_a_device_says_at_its_start_names_no_columns(tmp_path):
    table = table_of(tmp_path, ["MPU6050 found!", *rows(60, cells=2, sign=",")])
    assert table.names == ("", "")


@pytest.mark.parametrize(
    "line", ["// Update Rate: 100.0Hz", "Output Rate,100,Hz", "Capture Frame Rate;100", "# scan frequency = .1 kHz"]
)
def test_the_rate_of_a_table_has_many_names(tmp_path, line):
    table = table_of(tmp_path, [line, "a,b", *rows(60, cells=2, sign=",")])
    assert table.stated_rate[1] == pytest.approx(100.0)


def test_a_rate_of_bits_is_none_of_samples(tmp_path):
    assert table_of(tmp_path, ["# baud rate: 9600", "a,b", *rows(60, cells=2, sign=",")]).stated_rate is None


def test_a_table_that_lies_on_its_side_is_refused_in_one_sentence(tmp_path):
    time = ",".join(f"{k / 200:.3f}" for k in range(500))
    place = ",".join(f"{np.sin(k / 10):.4f}" for k in range(500))
    table = table_of(tmp_path, [f"Time [s],{time}", f"x [mm],{place}"])
    with pytest.raises(InputError, match="501 columns and 2 rows of numbers, perhaps a row for each channel"):
        inspect_table(table)


@pytest.mark.parametrize("names", ["", "a"])
@pytest.mark.parametrize("channels", [8, 40])
def test_a_table_of_many_channels_that_lies_on_its_side_is_refused_with_how_to_turn_it(tmp_path, names, channels):
    values = np.random.default_rng(0).normal(size=(channels, 2000))
    begin = [f"{names}{k}," if names else "" for k in range(channels)]
    table = table_of(
        tmp_path, [word + ",".join(f"{x:.4g}" for x in row) for word, row in zip(begin, values, strict=True)]
    )
    with pytest.raises(InputError, match=f"columns and {channels} rows of numbers, perhaps a row for each") as raised:
        inspect_table(table)
    assert "pandas.read_csv('run.csv', header=None, sep=None, engine='python').T.to_csv(" in str(raised.value)


@pytest.mark.parametrize(("name", "is_told"), [("Channel A", False), ("CH B", False), ("Probe A", False), ("a", True)])
def test_the_letter_of_an_oscilloscopes_channel_names_no_quantity(tmp_path, name, is_told):
    lines = [f"{k / 200:.4f};{np.exp(-k / 200) * np.sin(k / 5):.5f}" for k in range(600)]
    _, _, listed = guessed(table_of(tmp_path, [f"Time (s);{name} [mV]", *lines]))
    (found,) = [guess for guess in listed if guess.column.reference == f"{name} [mV]"]
    assert ("by its name" in found.why) == is_told


def test_a_unit_behind_in_is_that_of_its_column_and_no_name(tmp_path):
    lines = [f"{k / 100:.2f},{np.cos(0.3 * k):.4f},{np.sin(0.3 * k):.4f}" for k in range(400)]
    found, _, listed = guessed(table_of(tmp_path, ["in s,C1 in V,Weg in mm", *lines]))
    assert [found.table.unit(k) for k in range(3)] == ["s", "V", "mm"]
    assert (found.rate, found.time.guessed) == (pytest.approx(100.0), "")
    assert {str(guess.column.reference): guess.channel for guess in listed}["C1 in V"] is None
    assert [str(guess.column.reference) for guess in listed if guess.used] == ["Weg in mm"]


@pytest.mark.parametrize("name", ["plug in", "built in 2019", "x in place", "turn-in A"])
def test_an_in_before_no_unit_says_nothing(name, tmp_path):
    assert table_of(tmp_path, [f"t,{name}", *rows(60, 2, ",")]).unit(1) is None


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("alpha2_rad/s^2", "rad/s^2"),
        ("alpha2 rad/s^2", "rad/s^2"),
        ("run1/acc_m/s2", "m/s2"),
        ("omega_rad/s", "rad/s"),
        ("alpha-°/s²", "°/s²"),
        ("rad/s", "rad/s"),
        ("n_1/min", "1/min"),
        ("torque_N*m", "N*m"),
        ("t/s", "s"),
        ("v/m/s", "m/s"),
        ("v_m/m/s", "m/s"),
        ("a/(m/s^2)", "m/s^2"),
        ("a_m/(m/s^2)", "m/s^2"),
        ("F_t/N", "N"),
        ("x_1/mm", "mm"),
        ("t_1/s", "s"),
    ],
)
def test_a_unit_of_several_factors_at_the_end_of_a_name_is_read_whole(tmp_path, name, unit):
    table = table_of(tmp_path, [f"k;x;{name}", *rows(20)])
    assert table.unit(2) == unit


def test_what_a_column_is_is_seen_by_its_name_before_a_unit_of_several_factors(tmp_path):
    lines = ["t_s;n1_rad/s;T1_N*m", *(f"{k / 1e3:.3f};{k % 7};{k % 5}" for k in range(60))]
    found = guesses(inspect_table(table_of(tmp_path, lines)), "gear_pair")
    assert [(guess.channel, guess.unit) for guess in found] == [("pinion_speed", "rad/s"), ("pinion_torque", "N*m")]


@pytest.mark.parametrize("title", ["--- Pendolo di torsione ---", "Pendolo di torsione", "misura"])
@pytest.mark.parametrize("names", [("Tempo", "Forzante", "Pendolo"), ("t", "F", "x", "A", "fase")])
@pytest.mark.parametrize(("between", "sign"), [(",", "\t"), (";", "\t"), (",", ";"), ("\t", ";")])
def test_names_may_be_parted_by_another_sign_than_the_values_below(tmp_path, title, names, between, sign):
    table = table_of(tmp_path, [title, between.join(names), *rows(30, len(names), sign)])
    assert table.names == names
    assert table.notes[0] == "run.csv: 1 line(s) above the values are left out"


def test_a_title_of_as_many_words_as_columns_names_none_by_signs_alone(tmp_path):
    table = table_of(tmp_path, ["--- pendolo di torsione ---", *rows(30, 5)])
    assert table.names == ("",) * 5


@pytest.mark.parametrize("label", ["Channel name", "Name", "Signal"])
@pytest.mark.parametrize("begun", [["Timestamp,2020-03-16 17:04:51,Timestamp,2020-03-16 17:04:51"], []])
def test_labels_may_stand_again_before_every_channel(tmp_path, label, begun):
    head = [*begun, f'{label},"Force",{label},"Input 1"', 'Unit,"N",Unit,"V"']
    table = table_of(tmp_path, [*head, *(f"{k / 2000},{k % 7}.5,{k / 2000},{-k % 5}.25" for k in range(40))])
    timed = ("Time of Force", "Time of Input 1") if begun else ("", "")
    assert table.names == (timed[0], "Force", timed[1], "Input 1")
    assert [table.unit(k) for k in (1, 3)] == ["N", "V"]
    assert [table.unit(k) for k in (0, 2)] == ["s" if begun else None] * 2
    assert len(table.values(0)) == 40


def test_a_number_in_brackets_is_no_unit(tmp_path):
    table = table_of(tmp_path, ["t (s);pos (5);load [12]", *rows(20)])
    assert [table.unit(k) for k in range(3)] == ["s", None, None]


@pytest.mark.parametrize("more", ["", "Factor;2;3\n", "Sample rate;1000;1000\n"])
def test_rows_with_a_label_above_the_first_column_are_names_and_units(tmp_path, more):
    """The last row of such settings was a sample, and the row of units the names."""
    rows = "".join(f"{k};{k % 7};{k % 5}\n" for k in range(50))
    (tmp_path / "a.csv").write_text(f"Channel;1;2\nName;x;F\nUnit;mm;N\n{more}{rows}")
    table = read_table(tmp_path / "a.csv")
    assert table.names == ("", "x", "F")
    assert [table.unit(k) for k in range(3)] == [None, "mm", "N"]
    assert table.values(1)[0] == 0
    assert table.lengths == (50, 50, 50)


@pytest.mark.parametrize("last", ["# ", "#", "#\t"])
def test_names_parted_by_blanks_in_a_comment_above_an_empty_one_are_read(tmp_path, last):
    lines = ["# run end = 2017-03-30 11:52:49", "#  Time (S)   sumSignal  LR_Signal", last, *rows(40, 3, "\t")]
    table = table_of(tmp_path, lines)
    assert table.names == ("Time (S)", "sumSignal", "LR_Signal")
    found = inspect_table(table)
    assert (found.time.index, found.time.unit) == (0, "s")


def test_prose_in_a_comment_names_no_columns(tmp_path):
    table = table_of(tmp_path, ["# a run:  with weight,  at noon", *rows(40, 3, "\t")])
    assert table.names == ("", "", "")
