# For tests to source: prints the rows of the study in folder $1 without the columns of times; $osteomill is the program.
rows() {
  "$osteomill" study "$1" --report >/dev/null
  awk -F, -v OFS=, 'NR == 1 {for (n = 1; n <= NF; ++n) timed[n] = $n ~ /_us_|rate_hz/}
    {for (n = 1; n <= NF; ++n) if (timed[n]) $n = ""; print}' "$1/report/trials.csv"
}
