"""Read recordings from files, databases and objects in memory into a ``Trace``.

===================  ===================================================================
module               purpose
===================  ===================================================================
read                 ``rtamt.read`` and ``rtamt.scan``
formats              the list of file formats
source               the interface that every reader implements
ahead                chunks read in a thread while others are evaluated
selection            which columns are read, under which names, and which are timestamps
assemble             a source to a trace, whole or in chunks
numbers              the values of a column
member_columns       the columns of the members of groups
first_column         a first column that may hold the timestamps
timestamps           the time column, its unit and its values
dates                dates as text or objects to numpy dates
gaps                 missing samples: skipped or held
silence              signals that end long before the recording does
rows                 rows of Python objects to columns
frames               pandas, polars, xarray, arrow and numpy objects
json_values          values of JSON lines and messages
csv                  CSV files
csv_cells            text columns of CSV files to numbers and dates
csv_source           CSV files as a source
csv_arrow            plain decimal numbers of large CSV files, by pyarrow
arrow                Parquet and Arrow files and tables
excel                Excel workbooks
sql                  databases
ulog                 PX4 flight logs
mdf                  ASAM MDF files
rosbag               ROS bags
bag_topic            a topic of a bag: its columns, its clock, its messages as rows
message_fields       where the numbers are in a message
mcap                 recovery of damaged MCAP files, and refusal of those that are not of ROS 2
message_definitions  the definitions of messages in a bag
===================  ===================================================================
"""
