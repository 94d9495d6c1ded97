"""The interface to the user: commands, their answers, and the designer.

`answers` has the result of each command as frozen data with its text, JSON, table and picture,
`cli` the options and exit codes, `designing` what the designer in the browser computes.
"""
