//! Parquet files of nested columns, from columns in memory. Equal columns give equal bytes.

use std::sync::Arc;

use glam::DVec3;
use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::FormatError;

/// A column, or columns that belong together.
pub enum ParquetField {
    /// A struct.
    Group(&'static str, Vec<ParquetField>),
    /// Values, one for each row.
    Values(&'static str, ColumnValues),
}

/// One value for each row.
pub enum ColumnValues {
    /// Text.
    Text(Vec<String>),
    /// Signed integers of 64 bits.
    Integer(Vec<i64>),
    /// Integers of 64 bits without a sign.
    Unsigned(Vec<u64>),
    /// Numbers of 64 bits.
    Number(Vec<f64>),
    /// True or false.
    Flag(Vec<bool>),
    /// Numbers that are not known; how many.
    UnknownNumber(usize),
    /// Texts that are not known; how many.
    UnknownText(usize),
    /// Lists of texts.
    Texts(Vec<Vec<String>>),
    /// Lists of structs of `x`, `y` and `z`.
    Points(Vec<Vec<DVec3>>),
}

/// A struct of `x`, `y` and `z`.
pub fn vectors(name: &'static str, of: &[DVec3]) -> ParquetField {
    let axis = |i: usize| ColumnValues::Number(of.iter().map(|v| v[i]).collect());
    let axes = ["x", "y", "z"].into_iter().enumerate();
    ParquetField::Group(
        name,
        axes.map(|(i, axis_name)| ParquetField::Values(axis_name, axis(i)))
            .collect(),
    )
}

/// A file of `rows` rows with these columns.
pub fn to_bytes(rows: usize, fields: &[ParquetField]) -> std::result::Result<Vec<u8>, FormatError> {
    written(rows, fields).map_err(FormatError::new)
}

fn written(rows: usize, fields: &[ParquetField]) -> Result<Vec<u8>> {
    let types = fields.iter().map(schema_of).collect::<Result<Vec<TypePtr>>>()?;
    let schema = Type::group_type_builder("schema").with_fields(types).build()?;
    let properties = WriterProperties::builder()
        .set_created_by(concat!("sceneloom ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    if rows > 0 {
        let mut group = writer.next_row_group()?;
        for field in fields {
            write_field(&mut group, field)?;
        }
        group.close()?;
    }
    writer.into_inner()
}

fn schema_of(field: &ParquetField) -> Result<TypePtr> {
    let built = match field {
        ParquetField::Group(name, fields) => {
            group(name, fields.iter().map(schema_of).collect::<Result<_>>()?)?
        }
        ParquetField::Values(name, values) => match values {
            ColumnValues::Text(_) => text(name, Repetition::REQUIRED)?,
            ColumnValues::UnknownText(_) => text(name, Repetition::OPTIONAL)?,
            ColumnValues::Integer(_) => plain(name, Physical::INT64, Repetition::REQUIRED)?,
            ColumnValues::Number(_) => plain(name, Physical::DOUBLE, Repetition::REQUIRED)?,
            ColumnValues::UnknownNumber(_) => plain(name, Physical::DOUBLE, Repetition::OPTIONAL)?,
            ColumnValues::Flag(_) => plain(name, Physical::BOOLEAN, Repetition::REQUIRED)?,
            ColumnValues::Unsigned(_) => Type::primitive_type_builder(name, Physical::INT64)
                .with_repetition(Repetition::REQUIRED)
                .with_logical_type(Some(LogicalType::integer(64, false)))
                .build()?,
            ColumnValues::Texts(_) => list(name, text("element", Repetition::REQUIRED)?)?,
            ColumnValues::Points(_) => {
                let axis = |name| plain(name, Physical::DOUBLE, Repetition::REQUIRED).map(Arc::new);
                list(name, group("element", vec![axis("x")?, axis("y")?, axis("z")?])?)?
            }
        },
    };
    Ok(Arc::new(built))
}

fn group(name: &str, fields: Vec<TypePtr>) -> Result<Type> {
    let builder = Type::group_type_builder(name).with_repetition(Repetition::REQUIRED);
    builder.with_fields(fields).build()
}

fn plain(name: &str, kind: Physical, repetition: Repetition) -> Result<Type> {
    Type::primitive_type_builder(name, kind)
        .with_repetition(repetition)
        .build()
}

fn text(name: &str, repetition: Repetition) -> Result<Type> {
    Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
        .with_repetition(repetition)
        .with_logical_type(Some(LogicalType::String))
        .build()
}

/// A list as the format's document has it: a group that holds a repeated group that holds the element.
fn list(name: &str, element: Type) -> Result<Type> {
    let repeated = Type::group_type_builder("list")
        .with_repetition(Repetition::REPEATED)
        .with_fields(vec![Arc::new(element)])
        .build()?;
    Type::group_type_builder(name)
        .with_repetition(Repetition::REQUIRED)
        .with_logical_type(Some(LogicalType::List))
        .with_converted_type(ConvertedType::LIST)
        .with_fields(vec![Arc::new(repeated)])
        .build()
}

type RowGroupWriter<'a> = SerializedRowGroupWriter<'a, Vec<u8>>;

fn write_field(group: &mut RowGroupWriter<'_>, field: &ParquetField) -> Result<()> {
    let values = match field {
        ParquetField::Group(_, fields) => {
            return fields.iter().try_for_each(|field| write_field(group, field));
        }
        ParquetField::Values(_, values) => values,
    };
    match values {
        ColumnValues::Text(all) => {
            column::<ByteArrayType>(group, &all.iter().map(bytes).collect::<Vec<_>>(), None)
        }
        ColumnValues::Integer(all) => column::<Int64Type>(group, all, None),
        ColumnValues::Unsigned(all) => {
            // The bits are kept; the type says that there is no sign.
            column::<Int64Type>(
                group,
                &all.iter().map(|v| v.cast_signed()).collect::<Vec<_>>(),
                None,
            )
        }
        ColumnValues::Number(all) => column::<DoubleType>(group, all, None),
        ColumnValues::Flag(all) => column::<BoolType>(group, all, None),
        ColumnValues::UnknownNumber(count) => {
            column::<DoubleType>(group, &[], Some(NestingLevels::none(*count)))
        }
        ColumnValues::UnknownText(count) => {
            column::<ByteArrayType>(group, &[], Some(NestingLevels::none(*count)))
        }
        ColumnValues::Texts(lists) => {
            let all: Vec<ByteArray> = lists.iter().flatten().map(bytes).collect();
            column::<ByteArrayType>(group, &all, Some(NestingLevels::from_lists(lists)))
        }
        ColumnValues::Points(lists) => (0..3).try_for_each(|axis| {
            let all: Vec<f64> = lists.iter().flatten().map(|p| p[axis]).collect();
            column::<DoubleType>(group, &all, Some(NestingLevels::from_lists(lists)))
        }),
    }
}

fn bytes(text: &String) -> ByteArray {
    ByteArray::from(text.as_bytes().to_vec())
}

/// Which values are there, and which of them begin a row.
struct NestingLevels {
    definition: Vec<i16>,
    repetition: Option<Vec<i16>>,
}

impl NestingLevels {
    /// Levels of rows without any value.
    fn none(rows: usize) -> Self {
        Self {
            definition: vec![0; rows],
            repetition: None,
        }
    }

    fn from_lists<T>(lists: &[Vec<T>]) -> Self {
        let (mut definition, mut repetition) = (Vec::new(), Vec::new());
        for list in lists {
            definition.extend(std::iter::repeat_n(1, list.len()));
            repetition.extend((0..list.len()).map(|i| i16::from(i > 0)));
            if list.is_empty() {
                definition.push(0);
                repetition.push(0);
            }
        }
        Self {
            definition,
            repetition: Some(repetition),
        }
    }
}

fn column<T: parquet::data_type::DataType>(
    group: &mut RowGroupWriter<'_>,
    values: &[T::T],
    levels: Option<NestingLevels>,
) -> Result<()> {
    let Some(mut column) = group.next_column()? else {
        return Err(parquet::errors::ParquetError::General(
            "more columns than the schema has".into(),
        ));
    };
    let (definition, repetition) = match &levels {
        Some(levels) => (Some(&levels.definition[..]), levels.repetition.as_deref()),
        None => (None, None),
    };
    column.typed::<T>().write_batch(values, definition, repetition)?;
    column.close()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field as Cell;

    #[test]
    fn nested_columns_are_read_back_row_by_row() {
        let point = |x: f64| DVec3::new(x, -x, x / 2.0);
        let fields = [
            ParquetField::Group(
                "key",
                vec![
                    ParquetField::Values("clip_id", ColumnValues::Text(vec!["a \"b\"".into(), "ü".into()])),
                    ParquetField::Values("timestamp_micros", ColumnValues::Integer(vec![-1, 7])),
                ],
            ),
            vectors("center", &[point(1.0), point(3.0)]),
            ParquetField::Values(
                "rail",
                ColumnValues::Points(vec![vec![point(1.0), point(2.0), point(9.0)], vec![]]),
            ),
            ParquetField::Values(
                "styles",
                ColumnValues::Texts(vec![vec![], vec!["X".into(), "Y".into()]]),
            ),
            ParquetField::Values("limit", ColumnValues::UnknownNumber(2)),
            ParquetField::Values("implicit", ColumnValues::Flag(vec![true, false])),
            ParquetField::Values("version", ColumnValues::Unsigned(vec![1, u64::MAX])),
        ];
        let file = to_bytes(2, &fields).expect("sound");
        assert_eq!(file, to_bytes(2, &fields).expect("sound"));
        let reader = SerializedFileReader::new(bytes_of(file)).expect("parquet");
        let rows: Vec<_> = reader
            .get_row_iter(None)
            .expect("rows")
            .map(|r| r.expect("a row"))
            .collect();
        let text = rows.iter().map(|r| format!("{r}\n")).collect::<String>();
        let column = |row: usize, name: &str| {
            let mut all = rows[row].get_column_iter();
            all.find(|(n, _)| *n == name)
                .map(|(_, cell)| cell.clone())
                .expect(name)
        };
        assert_eq!(column(1, "version"), Cell::ULong(u64::MAX));
        assert_eq!(column(0, "limit"), Cell::Null);
        assert!(
            matches!(column(0, "rail"), Cell::ListInternal(list) if list.len() == 3),
            "{text}"
        );
        assert!(
            matches!(column(1, "rail"), Cell::ListInternal(list) if list.len() == 0),
            "{text}"
        );
        assert!(
            text.contains("{x: 9.0, y: -9E0, z: 4.5}") && text.contains("[\"X\", \"Y\"]"),
            "{text}"
        );
    }

    #[test]
    fn a_table_without_rows_has_its_columns() {
        let file = to_bytes(0, &[ParquetField::Values("rail", ColumnValues::Points(vec![]))]).expect("sound");
        let reader = SerializedFileReader::new(bytes_of(file)).expect("parquet");
        assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
        assert_eq!(reader.metadata().file_metadata().schema_descr().num_columns(), 3);
    }

    fn bytes_of(file: Vec<u8>) -> impl parquet::file::reader::ChunkReader + 'static {
        let mut temporary = tempfile::tempfile().expect("a file");
        std::io::Write::write_all(&mut temporary, &file).expect("written");
        temporary
    }
}
